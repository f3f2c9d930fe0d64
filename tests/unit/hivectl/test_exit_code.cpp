// Tests of exit codes and of the sentences for errors.
#include "words/exit_code.hpp"
#include "words/failures.hpp"
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

TEST_CASE("advice: a drone that does not run is to be started only where there is a program of its kind")
{
    const Programs programs({"hive-toy", "hive-toy-2"});
    CHECK(advice_for_missing("toy") == "start it: hivectl start toy");
    CHECK(advice_for_missing("toy-3") == "start it: hivectl start toy --as toy-3");
    CHECK(advice_for_missing("toy-2") == "start it: hivectl start toy-2");
    CHECK(advice_for_missing("nobody") == "see what runs: hivectl ps");
    CHECK(advice_for_missing("nobody-3") == "see what runs: hivectl ps");
}

TEST_CASE("error texts: the error's own advice stands behind its text, or else the advice for its code")
{
    CHECK(explained(Error(Errc::halted, "face has halted")) == "face has halted; resume it: hivectl resume NAME");
    CHECK(explained(Error(Errc::halted, "face has halted", "wait")) == "face has halted; wait");
    CHECK(explained(Error(Errc::refused, "no")) == "no");
}

TEST_CASE("failures: those that differ in the drone's name and in numbers are alike, others are not")
{
    const auto failure = [](const std::string& drone, const std::string& text) {
        return hive::SwarmFailure{drone, Error(Errc::failed, text)};
    };
    const auto groups = alike({failure("face-1", "face-1 ended with exit code 7:\none log"),
                               failure("camera", "cannot open /dev/video0"),
                               failure("face-12", "face-12 ended with exit code 9:\nanother log"),
                               failure("face-13", "face-13 did not start"), failure("e", "e ended with exit code 7:")});
    REQUIRE(groups.size() == 3);
    CHECK(groups[0].size() == 3);
    CHECK(groups[0][1].drone == "face-12");
    CHECK(groups[1][0].drone == "camera");
    CHECK(alike({}).empty());
}

TEST_CASE("error texts: what a text says is never taken for advice")
{
    CHECK(explained(Error(Errc::halted, "tea; or did you mean coffee?", "wait"))
          == "tea; or did you mean coffee?; wait");
}

TEST_CASE("error texts: what came from elsewhere is made printable, advice as well")
{
    CHECK(explained(Error(Errc::refused, "no\x1b[2J\n", "ask\x1b[2J")) == "no\\x1b[2J\\n; ask\\x1b[2J");
}
