// Programs whose output is read while others run beside them.
#include "running_command.hpp"

#include <hive/error.hpp>
#include <hive/failure.hpp>

#include <doctest/doctest.h>

#include <string>

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

/// A line of a shell.
std::vector<std::string> shell(const std::string& line) { return {"sh", "-c", line}; }

}  // namespace

TEST_CASE("command: what it prints and how it ends")
{
    const auto result = hive::run_command(shell("echo out; echo $WORD >&2; exit 3"), 30s, {"WORD=err"});
    CHECK(result.exit_code == 3);
    CHECK(result.out == "out\n");
    CHECK(result.err == "err\n");
    CHECK_FALSE(result.late);
    CHECK(hive::run_command(shell("kill -9 $$"), 30s).exit_code == 128 + 9);
    CHECK(hive::run_command(shell("head -c 1000000 /dev/zero"), 30s).out.size() == 1'000'000);
    CHECK_THROWS_AS(hive::run_command({"/no/such/program"}, 1s), hive::Error);
}

TEST_CASE("command: one that runs is not waited for unless that is wanted")
{
    hive::RunningCommand asleep(shell("exec sleep 60"), 60s);
    const auto begin = Clock::now();
    for (int i = 0; i < 100; ++i)
        CHECK_FALSE(asleep.poll());
    CHECK_FALSE(asleep.poll(20ms));
    CHECK(Clock::now() - begin >= 20ms);
    CHECK(Clock::now() - begin < 20s);
}

TEST_CASE("command: when its time is over it is ended, also if it does not want to")
{
    const auto polite = hive::run_command(shell("exec sleep 60"), 50ms);
    CHECK(polite.late);
    CHECK(polite.exit_code == 128 + 15);
    const auto cancelled = hive::run_command(shell("exec sleep 60"), 60s, {}, [] { return true; });
    CHECK(cancelled.late);
    const auto stubborn = hive::run_command(shell("trap '' TERM; echo on; while :; do sleep 1; done"), 2s);
    CHECK(stubborn.late);
    CHECK(stubborn.exit_code == 128 + 9);
}

TEST_CASE("command: more output than anybody needs is an error")
{
    CHECK_THROWS_WITH_AS(hive::run_command(shell("exec cat /dev/zero"), 60s), "a command printed more than 16 MiB",
                         hive::Error);
}

TEST_CASE("command: a failure is found among what a program printed, and is the error that it was")
{
    const hive::Error error(hive::Errc::name_taken, "face runs already:\n  here", "stop it");
    const auto line = hive::to_text(hive::failure_json(error, "face"));
    const auto found = hive::failure_in("Welcome to gpu1\n{not this}\n{\"error\": 1}\n" + line + "\nhivectl: a note\n");
    REQUIRE(found);
    CHECK(found->code() == error.code());
    CHECK(found->what() == std::string(error.what()));
    CHECK(found->advice() == error.advice());
    CHECK_FALSE(hive::failure_in("hivectl start: no such file\n{\"drone\": \"face\"}\n"));
    CHECK(hive::failure_json(error)
          == hive::Json{{"error", {{"code", "name_taken"}, {"text", error.what()}, {"advice", "stop it"}}}});
}
