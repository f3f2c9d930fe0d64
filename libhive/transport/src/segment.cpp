// Creates, seals and backs shared memory.
#include "segment.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>

namespace hive::transport {
namespace {

/// A file over this limit would not be refused, but kill the process (SIGXFSZ).
bool allowed(std::size_t size)
{
    rlimit limit{};
    return ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && (limit.rlim_cur == RLIM_INFINITY || size <= limit.rlim_cur);
}

}  // namespace

std::unique_ptr<Segment> Segment::create(std::size_t slot_size, std::uint32_t slots)
{
    const std::size_t size = slot_size * slots;
    Descriptor descriptor(::memfd_create("hive", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (!descriptor || !allowed(size) || ::ftruncate(descriptor.get(), static_cast<off_t>(size)) != 0)
        return nullptr;
    void* const base = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor.get(), 0);
    if (base == MAP_FAILED)
        return nullptr;
    auto segment =
        std::unique_ptr<Segment>(new Segment(std::move(descriptor), static_cast<std::byte*>(base), slot_size, slots));
    // From here on no process can change its size (a reader would get SIGBUS) or map it for writing again.
    if (::fcntl(segment->descriptor(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL)
        != 0)
        return nullptr;
    return segment;
}

Segment::Segment(Descriptor descriptor, std::byte* base, std::size_t slot_size, std::uint32_t slots)
    : descriptor_(std::move(descriptor)), base_(base), slot_size_(slot_size), generations_(slots)
{
    free_.reserve(slots);
}

Segment::~Segment() { ::munmap(base_, size()); }

bool Segment::contains(std::span<const std::byte> bytes) const noexcept
{
    return bytes.data() >= base_ && bytes.data() + bytes.size() <= base_ + size();
}

bool Segment::back_one() noexcept
{
    if (backed_ == slots()
        || ::fallocate(descriptor(), 0, static_cast<off_t>(backed_ * slot_size_), static_cast<off_t>(slot_size_)) != 0)
        return false;
    // Page faults at the first write would cost as much as writing the image; kernels before 5.14 have them anyway.
    ::madvise(at(backed_), slot_size_, MADV_POPULATE_WRITE);
    free_.push_back(backed_++);
    return true;
}

std::uint32_t Segment::take()
{
    const auto index = free_.back();
    free_.pop_back();
    ++generations_[index];
    return index;
}

}  // namespace hive::transport
