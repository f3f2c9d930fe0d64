// The drone contract: what every drone binary promises, whatever it does.
#include <possible.hpp>

#include "subject.hpp"

#include <string_view>

int main(int argc, char** argv)
{
    if (argc > 2 && std::string_view(argv[1]) == "--without-sockets")
        return subject::run_without_sockets(argv + 2);
    return hive::test::run_cases(argc, argv);
}
