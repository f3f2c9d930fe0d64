// Making and mapping shared blocks.
#include "board.hpp"

#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>
#include <sys/mman.h>

namespace hive::bench {
namespace {

constexpr auto board_variable = "HIVE_BENCH_BOARD", memory_variable = "HIVE_BENCH_MEMORY";

int inherited(const char* variable)
{
    const char* text = std::getenv(variable);
    if (!text)
        throw std::runtime_error(std::string(variable) + " is not set: roles are started by the controller");
    return std::stoi(text);
}

int make(const char* variable)
{
    const int descriptor = ::memfd_create(variable, 0);  // without CLOEXEC: the roles inherit it
    if (descriptor < 0)
        throw std::runtime_error("no memfd");
    ::setenv(variable, std::to_string(descriptor).c_str(), 1);
    return descriptor;
}

void* map(int descriptor)
{
    void* memory = ::mmap(nullptr, sizeof(Board), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor, 0);
    if (memory == MAP_FAILED)
        throw std::runtime_error("cannot map the board");
    return memory;
}

}  // namespace

Board& make_board()
{
    const int descriptor = make(board_variable);
    make(memory_variable);
    if (::ftruncate(descriptor, sizeof(Board)) != 0)
        throw std::runtime_error("cannot size the board");
    return *new (map(descriptor)) Board;
}

Board& inherited_board() { return *static_cast<Board*>(map(inherited(board_variable))); }
int frame_memory() { return inherited(memory_variable); }

}  // namespace hive::bench
