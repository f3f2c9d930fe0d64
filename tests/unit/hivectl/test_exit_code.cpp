// Tests of exit codes and of the sentences for errors.
#include "exit_code.hpp"
#include "programs_for_tests.hpp"

#include <doctest/doctest.h>

using namespace hivectl;
using hive::Errc;
using hive::Error;

TEST_CASE("exit codes: every error has the code that the documentation gives it")
{
    const std::pair<Errc, int> expected[] = {{Errc::invalid_argument, 2},
                                             {Errc::not_found, 3},
                                             {Errc::unreachable, 4},
                                             {Errc::connection_lost, 4},
                                             {Errc::timeout, 124},
                                             {Errc::refused, 5},
                                             {Errc::type_mismatch, 6},
                                             {Errc::halted, 7},
                                             {Errc::locked, 5},
                                             {Errc::name_taken, 1},
                                             {Errc::not_permitted, 5},
                                             {Errc::too_large, 5},
                                             {Errc::malformed, 1},
                                             {Errc::version_mismatch, 1},
                                             {Errc::unsupported, 5},
                                             {Errc::failed, 1},
                                             {Errc::abandoned, 1},
                                             {Errc::stopped, 4},
                                             {Errc::io, 1}};
    for (const auto& [code, exit] : expected) {
        CAPTURE(hive::info(code).token);
        CHECK(exit_code_of(code) == exit);
    }
}

TEST_CASE("exit codes: some done and some failed is 8; all failed alike is their code; all failed differently is 1")
{
    Outcome none("stop");
    CHECK(none.exit_code() == 0);
    Outcome alike("stop");
    alike.failed("a", Error(Errc::timeout, "a: no answer"));
    alike.failed("b", Error(Errc::timeout, "b: no answer"));
    CHECK(alike.exit_code() == 124);
    Outcome mixed("stop");
    mixed.failed("a", Error(Errc::timeout, "a: no answer"));
    mixed.failed("b", Error(Errc::refused, "b: no"));
    CHECK(mixed.exit_code() == 1);
    Outcome partly("stop");
    partly.done();
    partly.failed("b", Error(Errc::timeout, "b: no answer"));
    CHECK(partly.exit_code() == 8);
}

TEST_CASE("error texts: a drone that does not run is to be started only where there is a program of its kind")
{
    const Programs programs({"hive-toy", "hive-toy-2"});
    const auto advice = [](const std::string& drone) {
        return explained(Error(Errc::not_found, drone + " is not running"));
    };
    CHECK(advice("toy") == "toy is not running; start it: hivectl start toy");
    CHECK(advice("toy-3") == "toy-3 is not running; start it: hivectl start toy --as toy-3");
    CHECK(advice("toy-2") == "toy-2 is not running; start it: hivectl start toy-2");
    CHECK(advice("nobody") == "nobody is not running; see what runs: hivectl ps");
    CHECK(advice("nobody-3") == "nobody-3 is not running; see what runs: hivectl ps");
    CHECK(explained(Error(Errc::not_found, "tay is not running; did you mean toy?"))
          == "tay is not running; did you mean toy?");
}

TEST_CASE("error texts: advice is added once, and what came from elsewhere is made printable")
{
    CHECK(explained(Error(Errc::halted, "face has halted")) == "face has halted; let it go on: hivectl resume NAME");
    CHECK(explained(Error(Errc::not_found, "no fase; did you mean face?")) == "no fase; did you mean face?");
    CHECK(explained(Error(Errc::refused, "no\x1b[2J\n")) == "no\\x1b[2J\\n");
}
