// Sizing, mapping and filling the shared memory.
#include "segment.hpp"

#include <new>
#include <stdexcept>
#include <sys/mman.h>
#include <sys/stat.h>

namespace hive::bench {
namespace {

constexpr Nanoseconds timeout = 5 * second;

template <class Condition>
void await_maker(Condition there)
{
    for (const auto end = now_ns() + timeout; !there(); sleep_for(millisecond))
        if (now_ns() > end)
            throw std::runtime_error("nobody made the shared memory");
}

bool has_size(std::size_t size)
{
    struct stat status {};
    return ::fstat(frame_memory(), &status) == 0 && status.st_size >= static_cast<off_t>(size);
}

}  // namespace

Segment::Segment(std::size_t frame, Role role) : frame_(frame), stride_((frame + page - 1) / page * page)
{
    const std::size_t size = page + slots * stride_;
    const bool maker = role == Role::publisher || role == Role::server;
    if (maker && ::ftruncate(frame_memory(), static_cast<off_t>(size)) != 0)
        throw std::runtime_error("cannot size the shared memory");
    await_maker([&] { return has_size(size); });
    void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, frame_memory(), 0);
    if (memory == MAP_FAILED)
        throw std::runtime_error("cannot map the shared memory");
    base_ = static_cast<std::byte*>(memory);
    maker ? fill() : touch_all(size);
}

void Segment::fill() const
{
    for (std::uint32_t i = 0; i < slots; ++i)
        draw(slot(i), i % cameras);
    (new (base_) Control)->ready = 1;
}

void Segment::touch_all(std::size_t size) const
{
    await_maker([&] { return control().ready != 0; });
    for (std::size_t i = 0; i < size; i += page)
        (void)*static_cast<volatile std::byte*>(base_ + i);
}

void Segment::put(const Frame& frame, std::uint32_t index, bool in_place) const
{
    if (!in_place)
        return frame.produce(slot(index).data());
    Frame drawn = frame;
    drawn.header.camera = index % cameras;
    drawn.stamp(slot(index).data());
}

}  // namespace hive::bench
