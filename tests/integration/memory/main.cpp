// Runs the tests, or is one of the processes that they kill.
#include "peers.hpp"

#include <doctest/doctest.h>

int main(int argc, char** argv)
{
    if (argc == 4 && std::string(argv[1]) == "--peer")
        return memory::run_peer(argv[2], argv[3]);
    return doctest::Context(argc, argv).run();
}
