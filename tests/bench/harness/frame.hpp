// The frames that every row moves, the cameras that they come from, and how a receiver proves that one is whole.
#pragma once

#include "clock.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace hive::bench {

/// probe: is the receiver there? warm: not measured. measured. end: no more will come.
enum class Kind : std::uint32_t { probe = 1, warm, measured, end };

struct FrameHeader {
    std::uint64_t magic;
    std::uint64_t sequence;
    Nanoseconds produced;  ///< before the image was copied
    Kind kind;
    std::uint32_t camera;  ///< whose pattern the image has
};
static_assert(sizeof(FrameHeader) == 32);

/// What a client sends: 64 bytes.
struct alignas(64) Request {
    FrameHeader header;
};

using FrameTail = std::uint64_t;  ///< the sequence again
constexpr std::uint64_t frame_magic = 0x4556494842454e43;
constexpr std::size_t cameras = 4;  ///< like the buffers of a capture device, in rotation
constexpr std::size_t least_frame = sizeof(FrameHeader) + sizeof(FrameTail);

/// Reads one byte of each cache line between header and tail; their sum.
std::uint32_t touch(std::span<const std::byte> frame);
/// Fills an image with the pattern of a camera.
void draw(std::span<std::byte> image, std::size_t camera);

/// A frame that is to be produced. The transport says where.
struct Frame {
    FrameHeader header;
    std::span<const std::byte> image;  ///< in the camera's buffer; as large as the frame

    /// Writes header and tail: the camera has put its image there already.
    void stamp(std::byte* into) const;
    /// Copies the image and stamps it.
    void produce(std::byte* into) const;
};

/// Memory that begins at a page, as that of a capture device does.
struct FreePages {
    void operator()(std::byte* pages) const noexcept;
};
using Pages = std::unique_ptr<std::byte[], FreePages>;
Pages make_pages(std::size_t size);

/// The camera buffers.
class Cameras {
public:
    explicit Cameras(std::size_t size);
    [[nodiscard]] Frame frame(std::uint64_t sequence, Kind kind) const;
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

private:
    std::size_t size_;
    std::array<Pages, cameras> images_;
};

/// Touches a frame that came and says whether it is the one that was sent.
class FrameCheck {
public:
    explicit FrameCheck(std::size_t size);
    /// The header, whatever the rest is like; magic 0 when there is none.
    [[nodiscard]] static FrameHeader header(std::span<const std::byte> frame);
    /// Every line is read, then size, sum, header and tail are compared.
    [[nodiscard]] bool whole(std::span<const std::byte> frame) const;

private:
    std::size_t size_;
    std::array<std::uint32_t, cameras> sums_{};
};

}  // namespace hive::bench
