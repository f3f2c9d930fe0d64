// Drawing, copying and checking frames.
#include "frame.hpp"

#include <cstdlib>
#include <cstring>
#include <new>

namespace hive::bench {
namespace {

constexpr std::size_t line = 64;

std::uint32_t at(std::span<const std::byte> frame, std::size_t index)
{
    return std::to_integer<std::uint32_t>(frame[index]);
}

}  // namespace

std::uint32_t touch(std::span<const std::byte> frame)
{
    // Four sums, so that the loads do not wait for one another. The first and the last line are checked on their own.
    std::uint32_t a = 0, b = 0, c = 0, d = 0;
    const std::size_t end = frame.size() > 2 * line ? frame.size() - line : 0;
    std::size_t i = line;
    for (; i + 3 * line < end; i += 4 * line) {
        a += at(frame, i);
        b += at(frame, i + line);
        c += at(frame, i + 2 * line);
        d += at(frame, i + 3 * line);
    }
    for (; i < end; i += line)
        a += at(frame, i);
    return a + b + c + d;
}

void draw(std::span<std::byte> image, std::size_t camera)
{
    auto value = 0x9e3779b9u * static_cast<std::uint32_t>(camera + 1);
    for (auto& byte : image) {
        value = value * 1664525u + 1013904223u;
        byte = static_cast<std::byte>(value >> 24);
    }
}

void Frame::stamp(std::byte* into) const
{
    std::memcpy(into, &header, sizeof header);
    std::memcpy(into + image.size() - sizeof(FrameTail), &header.sequence, sizeof(FrameTail));
}

void Frame::produce(std::byte* into) const
{
    std::memcpy(into, image.data(), image.size());
    stamp(into);
}

void FreePages::operator()(std::byte* pages) const noexcept { std::free(pages); }

Pages make_pages(std::size_t size)
{
    constexpr std::size_t page = 4096;
    auto* pages = static_cast<std::byte*>(std::aligned_alloc(page, (size + page - 1) / page * page));
    if (!pages)
        throw std::bad_alloc();
    return Pages(pages);
}

Cameras::Cameras(std::size_t size) : size_(size)
{
    for (std::size_t camera = 0; camera < cameras; ++camera) {
        images_[camera] = make_pages(size);
        draw({images_[camera].get(), size}, camera);
    }
}

Frame Cameras::frame(std::uint64_t sequence, Kind kind) const
{
    const auto camera = static_cast<std::uint32_t>(sequence % cameras);
    return {{frame_magic, sequence, now_ns(), kind, camera}, {images_[camera].get(), size_}};
}

FrameCheck::FrameCheck(std::size_t size) : size_(size)
{
    const auto image = make_pages(size);
    for (std::size_t camera = 0; camera < cameras; ++camera) {
        draw({image.get(), size}, camera);
        sums_[camera] = touch({image.get(), size});
    }
}

FrameHeader FrameCheck::header(std::span<const std::byte> frame)
{
    FrameHeader header{};
    if (frame.size() >= least_frame)
        std::memcpy(&header, frame.data(), sizeof header);
    return header.magic == frame_magic ? header : FrameHeader{};
}

bool FrameCheck::whole(std::span<const std::byte> frame) const
{
    const auto sum = touch(frame);
    const auto head = header(frame);
    if (frame.size() != size_ || head.magic != frame_magic || head.camera >= cameras)
        return false;
    FrameTail tail = 0;
    std::memcpy(&tail, frame.data() + frame.size() - sizeof tail, sizeof tail);
    return tail == head.sequence && sum == sums_[head.camera];
}

}  // namespace hive::bench
