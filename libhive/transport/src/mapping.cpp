// Checks seals, maps segments, and copies bodies.
#include "mapping.hpp"

#include "os_text.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <algorithm>

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

/// Huge pages are mapped and made private in other units than slots.
void require_usual_pages(int descriptor)
{
    struct statfs status {};
    if (::fstatfs(descriptor, &status) != 0 || status.f_type == HUGETLBFS_MAGIC)
        throw Error(Errc::malformed, "shared memory of huge pages");
}

std::uint64_t page_size() { return static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)); }

/// Only whole pages can become private one slot at a time.
void require_whole_pages(std::uint64_t slot_size)
{
    if (slot_size % page_size() != 0)
        throw Error(Errc::malformed, "shared memory in slots of " + std::to_string(slot_size)
                                         + " bytes, not a multiple of the page size");
}

}  // namespace

std::shared_ptr<Mapping> Mapping::map(const protocol::Segment& offered, const Descriptor& descriptor)
{
    const auto size = offered.slots * offered.slot_size;
    require_whole_pages(offered.slot_size);
    require_sealed(descriptor.get());
    require_usual_pages(descriptor.get());
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

void Mapping::check(const protocol::Reference& reference, std::uint64_t most) const
{
    if (reference.slot.index >= segment_.slots || reference.offset > segment_.slot_size
        || reference.size > segment_.slot_size - reference.offset)
        throw Error(Errc::malformed, "a reference to " + std::to_string(reference.size) + " bytes outside their slot");
    require_at_most("a body", reference.size, most);
}

// The first reader of a never written page allocates it: a peer could make this process allocate gigabytes. The seals
// ensure that existing pages stay.
std::span<const std::byte> Mapping::bytes(const protocol::Reference& reference)
{
    const std::span<const std::byte> bytes(base_ + reference.slot.index * segment_.slot_size + reference.offset,
                                           reference.size);
    auto& seen = seen_[reference.slot.index];
    if (bytes.empty() || (bytes.data() >= seen.data() && bytes.data() + bytes.size() <= seen.data() + seen.size()))
        return bytes;
    const auto pages = pages_of(bytes);
    std::vector<unsigned char> there(pages.size() / page_size());
    if (::mincore(pages.data(), pages.size(), there.data()) != 0
        || std::ranges::any_of(there, [](unsigned char page) { return (page & 1) == 0; }))
        throw Error(Errc::io, "a reference to memory that was never written or no longer exists");
    ::madvise(pages.data(), pages.size(), MADV_POPULATE_READ);  // otherwise page by page, as on old kernels
    seen = pages;
    return bytes;
}

std::span<std::byte> Mapping::pages_of(std::span<const std::byte> bytes) noexcept
{
    const auto page = page_size();
    const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data()) / page * page;
    const auto end = (reinterpret_cast<std::uintptr_t>(bytes.data()) + bytes.size() + page - 1) / page * page;
    return {reinterpret_cast<std::byte*>(begin), end - begin};
}

void Mapping::make_private(std::span<const std::byte> bytes) noexcept
{
    const auto pages = pages_of(bytes);
    if (pages.empty())
        return;
    void* const copy = ::mmap(nullptr, pages.size(), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (copy == MAP_FAILED)
        return;  // without memory the old image may be overwritten; there is no alternative
    std::memcpy(copy, pages.data(), pages.size());
    ::mprotect(copy, pages.size(), PROT_READ);
    if (::mremap(copy, pages.size(), pages.size(), MREMAP_MAYMOVE | MREMAP_FIXED, pages.data()) == MAP_FAILED)
        ::munmap(copy, pages.size());
}

}  // namespace hive::transport
