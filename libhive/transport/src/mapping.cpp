// Checking seals, mapping, copying away.
#include "mapping.hpp"

#include "socket_stream.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive::transport {
namespace {

void require_sealed(int descriptor)
{
    constexpr int needed = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL, either = F_SEAL_FUTURE_WRITE | F_SEAL_WRITE;
    const int seals = ::fcntl(descriptor, F_GET_SEALS);
    if (seals < 0 || (seals & needed) != needed || (seals & either) == 0)
        throw Error(Errc::malformed, "shared memory that is not sealed");
}

void require_size(int descriptor, std::uint64_t size)
{
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || static_cast<std::uint64_t>(status.st_size) < size)
        throw Error(Errc::malformed, "shared memory of " + std::to_string(status.st_size) + " bytes that says it has "
                                         + std::to_string(size));
}

std::uint64_t page_size() { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

/// Only whole pages can become private one slot at a time.
void require_whole_pages(std::uint64_t slot_size)
{
    if (slot_size % page_size() != 0)
        throw Error(Errc::malformed, "shared memory in slots of " + std::to_string(slot_size)
                                         + " bytes, which is no multiple of a page");
}

}  // namespace

std::shared_ptr<Mapping> Mapping::map(const protocol::Segment& offered, const Descriptor& descriptor)
{
    const auto size = offered.slots * offered.slot_size;
    require_whole_pages(offered.slot_size);
    require_sealed(descriptor.get());
    require_size(descriptor.get(), size);
    void* const base = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor.get(), 0);
    if (base == MAP_FAILED)
        throw Error(Errc::io, "shared memory cannot be mapped: " + os_text(errno));
    return std::shared_ptr<Mapping>(new Mapping(offered, static_cast<std::byte*>(base)));
}

Mapping::Mapping(const protocol::Segment& segment, std::byte* base)
    : segment_(segment), base_(base), seen_(segment.slots)
{
}

Mapping::~Mapping() { ::munmap(base_, segment_.slots * segment_.slot_size); }

std::span<const std::byte> Mapping::bytes(const protocol::Reference& reference, std::uint64_t most)
{
    const auto index = reference.slot.index;
    if (index >= segment_.slots || reference.offset > segment_.slot_size
        || reference.size > segment_.slot_size - reference.offset)
        throw Error(Errc::malformed, "a reference to " + std::to_string(reference.size) + " bytes outside their slot");
    require_at_most("a body", reference.size, most);
    if (!seen_[index]) {
        const auto before = reference.offset % page_size();
        ::madvise(at(index) + reference.offset - before, before + reference.size,
                  MADV_POPULATE_READ);  // else page by page; old kernels do that
    }
    seen_[index] = true;
    return {at(index) + reference.offset, reference.size};
}

void Mapping::make_private(std::uint32_t index) noexcept
{
    const auto size = segment_.slot_size;
    void* const copy = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (copy == MAP_FAILED)
        return;  // without memory the old picture may be overwritten; there is nothing better to do
    std::memcpy(copy, at(index), size);
    ::mprotect(copy, size, PROT_READ);
    if (::mremap(copy, size, size, MREMAP_MAYMOVE | MREMAP_FIXED, at(index)) == MAP_FAILED)
        ::munmap(copy, size);
}

}  // namespace hive::transport
