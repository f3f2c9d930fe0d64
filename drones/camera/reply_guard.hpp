// Judges the replies of a network camera (HTTP and RTSP) line by line, before FFmpeg acts on them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace camera {

struct ReplyRules {
    bool rtsp = false;
    bool has_login = false;
    bool basic_allowed = false;  ///< may the password be sent unencrypted?
    bool redirects_allowed = false;
    long max_content = 64 * 1024;      ///< bytes of the body of an RTSP reply
    std::size_t max_head = 64 * 1024;  ///< bytes of the head of one reply
    int max_challenges = 8;            ///< replies that require a login
};

/// No socket, no clock. Once it has refused a reply, nothing more may be sent to the camera or read from it.
class ReplyGuard {
public:
    explicit ReplyGuard(ReplyRules rules) : rules_(rules) {}

    /// @param line  of the head of a reply, without its end; an empty line ends the head
    void take(std::string_view line);
    /// Why the camera is refused, as the rest of a sentence; empty: accepted.
    [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }
    void refuse(const std::string& reason);

private:
    void start_reply(std::string_view status_line);
    void take_field(std::string_view name, std::string_view value);
    void take_challenge(std::string_view value);
    void judge_head();

    ReplyRules rules_;
    std::string refusal_, location_;
    int status_ = 0, challenges_ = 0;
    std::size_t head_size_ = 0;
    bool in_head_ = false, offers_basic_ = false, offers_digest_ = false;
};

}  // namespace camera
