// Runs the tests, or is one of the processes that they kill.
#include "peers.hpp"

#include <possible.hpp>

int main(int argc, char** argv)
{
    if (argc == 4 && std::string(argv[1]) == "--peer")
        return memory::run_peer(argv[2], argv[3]);
    return hive::test::run_cases(argc, argv);
}
