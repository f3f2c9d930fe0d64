// A drone that dies of a signal: its log has the stack, ps the frame, and its exit status is unchanged.
#include "process.hpp"
#include "swarm.hpp"

#include <hive/application.hpp>

#include <csignal>
#include <doctest/doctest.h>
#include <fstream>

namespace {

using namespace hive;
using hive::test::has;
using hive::test::Swarm;

/// A crasher with only this folder in its search path.
test::Process crasher_with_path(const Swarm& swarm, const std::string& path)
{
    test::Process drone({"/usr/bin/env", "PATH=" + path, swarm.program("hive-crasher").string(), "--name", "boom"},
                        {"HIVE_HOME=" + swarm.home().string()}, swarm.home() / "boom.log");
    auto application = swarm.application();
    REQUIRE(test::eventually([&] { return !application.drones().empty(); }));
    return drone;
}

/// Makes a drone crash at its next event. @return its exit status
int die(const Swarm& swarm, test::Process& drone, const std::string& name)
{
    auto application = swarm.application();
    try {
        application.put({name, "in"}, Json::object(), Body(std::string("x")), "text/plain");
    } catch (const Error&) {
        // It may exit before it has answered.
    }
    return drone.wait(test::patient(std::chrono::seconds(20))).value_or(-1);
}

Json ps_row(const Swarm& swarm, const std::string& name)
{
    return Json::parse(swarm.hivectl_done({"ps", name, "--json"})).at(0);
}

struct Case {
    const char *how, *signal, *function;
};

}  // namespace

TEST_CASE("crash: the log has the stack, ps the first frame of the drone's own, and the signal stays")
{
    for (const auto& [how, signal, function] : {Case{"null", "SIGSEGV", "crasher::write_to_null("},
                                                {"stack", "SIGSEGV", "crasher::use_up_the_stack("},
                                                {"heap", "SIGABRT", "crasher::free_twice("},
                                                {"abort", "SIGABRT", "crasher::crash("},
                                                {"throw", "SIGABRT", "crasher::throw_uncaught("}}) {
        CAPTURE(how);
        const Swarm swarm;
        auto drone = swarm.drone("crasher", "boom", {std::string("how=") + how});
        CHECK(die(swarm, drone, "boom") == 128 + (std::string_view(signal) == "SIGSEGV" ? SIGSEGV : SIGABRT));
        const auto log = swarm.log("boom");
        CAPTURE(log);
        CHECK(has(log, std::string("crashed: ") + signal));
        CHECK(has(log, function));
        CHECK(has(log, "crasher.cpp:"));
        CHECK(has(log, "hive::service::Worker::run()")
              == (std::string_view(how) != "throw" && std::string_view(how) != "stack"));
        const auto row = ps_row(swarm, "boom");
        CAPTURE(row.dump());
        CHECK(row.at("state") == "crashed");
        CHECK(row.at("crash").at("signal") == signal);
        CHECK(row.at("crash").at("function").get<std::string>().starts_with(function));
        CHECK(has(row.at("crash").at("source"), "crasher.cpp:"));
        CHECK(row.at("crash").at("pid") == drone.pid());
        CHECK(has(swarm.hivectl_done({"ps"}), std::string(signal) + " in " + function));
    }
}

#ifdef __x86_64__
TEST_CASE("crash: a call through a null pointer is the fault of the caller")
{
    const Swarm swarm;
    auto drone = swarm.drone("crasher", "boom", {"how=call"});
    CHECK(die(swarm, drone, "boom") == 128 + SIGSEGV);
    CHECK(ps_row(swarm, "boom").at("crash").at("function").get<std::string>().starts_with("crasher::call_null("));
}
#endif

TEST_CASE("crash: without eu-addr2line the log has the exported names and the addresses")
{
    const Swarm swarm;
    auto drone = crasher_with_path(swarm, "/nowhere");
    CHECK(die(swarm, drone, "boom") == 128 + SIGSEGV);
    CHECK_MESSAGE(has(swarm.log("boom"), "hive-crasher(+0x"), swarm.log("boom"));
    CHECK(has(swarm.log("boom"), "Worker"));
    CHECK(ps_row(swarm, "boom").at("crash").at("function").get<std::string>().starts_with("hive-crasher+0x"));
}

TEST_CASE("crash: an eu-addr2line that hangs does not keep the drone alive")
{
    const Swarm swarm;
    const auto folder = swarm.home() / "programs";
    std::filesystem::create_directory(folder);
    std::ofstream(folder / "eu-addr2line") << "#!/bin/sh\nexec /bin/sleep 60\n";
    std::filesystem::permissions(folder / "eu-addr2line", std::filesystem::perms::owner_all);
    auto drone = crasher_with_path(swarm, folder.string());
    const auto begin = std::chrono::steady_clock::now();
    CHECK(die(swarm, drone, "boom") == 128 + SIGSEGV);
    CHECK(std::chrono::steady_clock::now() - begin < test::patient(std::chrono::seconds(6)));
    CHECK_MESSAGE(has(swarm.log("boom"), "hive-crasher(+0x"), swarm.log("boom"));
}

TEST_CASE("crash: it is forgotten when the drone starts again, and when it is stopped")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "crasher", "--as", "boom"});
    const auto crash = [&] {
        auto application = swarm.application();
        const auto pid = static_cast<pid_t>(application.status("boom").pid);
        ::kill(pid, SIGSEGV);
        REQUIRE(test::eventually([&] { return !application.crashed().empty(); }));
        CHECK(application.crashed().at(0).signal == "SIGSEGV");
    };
    crash();
    swarm.hivectl_done({"start", "crasher", "--as", "boom"});
    CHECK(ps_row(swarm, "boom").at("state") == "idle");
    CHECK_FALSE(std::filesystem::exists(swarm.home() / "boom.crash"));
    crash();
    swarm.hivectl_done({"stop", "boom"});
    CHECK(swarm.application().crashed().empty());
    CHECK(swarm.hivectl_done({"ps", "--json"}) == "[]\n");
    CHECK(swarm.hivectl({"ps", "boom"}).exit_code == 3);
}

TEST_CASE("crash: a drone that dies as it starts is shown, and is forgotten by stop")
{
    const Swarm swarm;
    CHECK(swarm.hivectl({"start", "crasher", "at_start=null", "--as", "boom"}).exit_code != 0);
    CHECK(ps_row(swarm, "boom").at("crash").at("function").get<std::string>().starts_with("crasher::write_to_null("));
    swarm.hivectl_done({"stop", "boom"});
    CHECK(swarm.hivectl_done({"ps", "--json"}) == "[]\n");
}

TEST_CASE("crash: of a drone that fell too often ps has one row, with the frame and not the last line of the log")
{
    const Swarm swarm;
    auto drone = swarm.drone("crasher", "boom");
    CHECK(die(swarm, drone, "boom") == 128 + SIGSEGV);
    std::ofstream(swarm.home() / "boom.failed") << R"({"reason": "fell 6 times within 60 s", "log": "last line\n"})";
    const auto rows = Json::parse(swarm.hivectl_done({"ps", "--json"}));
    REQUIRE(rows.size() == 1);
    CHECK(rows.at(0).at("state") == "failed");
    CHECK(has(rows.at(0).at("note"), "fell 6 times within 60 s: SIGSEGV in crasher::write_to_null("));
    CHECK(rows.at(0).at("crash").at("pid") == drone.pid());
}
