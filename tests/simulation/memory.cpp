// Memory for a program of one thread: freed blocks are kept by size and handed out again, without the locks and the
// merging of the C library, which cost a quarter of all instructions.
#include <array>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t step = 16, classes = 64;  ///< larger blocks come from the C library
constexpr std::size_t chunk_size = 256 * 1024;

struct Block {
    Block* next;
};

std::array<Block*, classes + 1> unused{};
std::byte* chunk = nullptr;
std::size_t left = 0;

/// Before each block is its class; 0: it came from the C library.
struct Header {
    std::size_t size_class;
    std::size_t padding;
};
static_assert(sizeof(Header) == step);

std::byte* carve(std::size_t size)
{
    if (left < size) {
        chunk = static_cast<std::byte*>(std::malloc(chunk_size));
        if (!chunk)
            throw std::bad_alloc();
        left = chunk_size;
    }
    left -= size;
    return chunk + left;
}

void* allocate(std::size_t size)
{
    const auto size_class = (size + step - 1) / step;
    if (size_class <= classes)
        if (auto* const block = unused[size_class]) {
            unused[size_class] = block->next;
            return block;
        }
    auto* const header =
        reinterpret_cast<Header*>(size_class <= classes ? carve(sizeof(Header) + size_class * step)
                                                        : static_cast<std::byte*>(std::malloc(sizeof(Header) + size)));
    if (!header)
        throw std::bad_alloc();
    header->size_class = size_class <= classes ? size_class : 0;
    return header + 1;
}

void release(void* memory) noexcept
{
    if (!memory)
        return;
    auto* const header = static_cast<Header*>(memory) - 1;
    if (header->size_class == 0)
        return std::free(header);
    auto* const block = static_cast<Block*>(memory);
    block->next = unused[header->size_class];
    unused[header->size_class] = block;
}

}  // namespace

void* operator new(std::size_t size) { return allocate(size > 0 ? size : 1); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
