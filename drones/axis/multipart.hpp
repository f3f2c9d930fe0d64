// Splits a stream of images (multipart/x-mixed-replace) into its parts, and tolerates real cameras: lengths may be
// missing or wrong, boundaries may have too many or too few dashes, and there may be any bytes between two parts.
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
    std::string bytes;  ///< between two boundaries, or by its length; not checked
};

/// The boundary that a Content-Type names, without quotes; nothing if it is not multipart or has none.
std::optional<std::string> boundary_of(std::string_view content_type);

/// Bytes in, parts out: no socket, no clock.
class MultipartReader {
public:
    static constexpr std::size_t max_part = 16u << 20, max_head = 8192;

    explicit MultipartReader(std::string_view boundary);

    /// @throws CameraError  too_large: a part over 16 MiB or a head over 8 KiB; not_an_image: no boundary in 16 MiB
    void feed(std::string_view bytes);
    /// The stream has ended: a part without a length may be complete.
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

    std::string boundary_;  ///< "--name", for any number of leading dashes
    std::string buffer_;
    Phase phase_ = Phase::between;
    std::size_t length_ = 0;   ///< counted: by the head
    std::size_t seen_ = 0;     ///< open: this much of the buffer has no boundary
    std::size_t skipped_ = 0;  ///< between: bytes since the last part
    std::map<std::string, std::string> head_;
    std::size_t head_size_ = 0;
    std::deque<Part> parts_;
};

}  // namespace axis
