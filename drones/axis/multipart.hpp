// Splits a stream of pictures (multipart/x-mixed-replace) into its parts, as cameras really write it: lengths may be
// missing or wrong, boundaries have too many or too few dashes, and anything may lie between two parts.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace axis {

struct Part {
    std::string type;   ///< of its Content-Type; empty if it has none
    std::string bytes;  ///< what came between two boundaries, or as many bytes as it said; not checked
};

/// The boundary that a Content-Type names, without quotes; nothing if it is no multipart or names none.
std::optional<std::string> boundary_of(std::string_view content_type);

/// Bytes in, parts out: no socket, no clock.
class MultipartReader {
public:
    static constexpr std::size_t most_part = 16u << 20, most_head = 8192;

    explicit MultipartReader(std::string_view boundary);

    /// @throws CameraError  too_large: a part over 16 MiB or a head over 8 KiB; not_a_picture: no boundary in 16 MiB
    void feed(std::string_view bytes);
    /// The stream has ended: a part that did not say its length may be whole all the same.
    void finish();
    std::optional<Part> next();

private:
    enum class Phase { between, head, counted, open };

    bool step();
    bool seek();
    bool read_head();
    bool read_counted();
    bool read_open();
    bool pass_boundary(std::size_t at);
    void begin_body();
    void give(std::size_t size);
    void drop(std::size_t size);

    std::string boundary_;  ///< "--name", whatever dashes the camera writes before it
    std::string buffer_;
    Phase phase_ = Phase::between;
    std::size_t length_ = 0;   ///< counted: what the head says
    std::size_t seen_ = 0;     ///< open: so much of the buffer has no boundary in it
    std::size_t skipped_ = 0;  ///< between: bytes since the last part
    std::map<std::string, std::string> head_;
    std::size_t head_size_ = 0;
    std::deque<Part> parts_;
};

}  // namespace axis
