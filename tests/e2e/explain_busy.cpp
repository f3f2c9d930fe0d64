// hivectl explain: a machine whose processors are all busy. The test takes all of them, and needs most of them itself,
// so it runs alone.
#include "explained.hpp"

#include <doctest/doctest.h>

#include <unistd.h>

using namespace hive::test;
using hive::Json;

TEST_CASE("explain: a machine whose processors are all busy, with who uses them")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=20"}), worker = swarm.drone("sleeper", "worker");
    swarm.hivectl_done({"connect", "source", "worker"});
    Found first;
    const auto full = [&](const std::string& words = "explain worker") {
        const auto now = found(swarm, words);
        if (first.json.is_null() && !now.json.at("causes").empty())
            first = now;
        for (const auto& cause : now.json.at("causes"))
            if (cause.at("what") == "load")
                return cause;
        return Json();
    };
    std::vector<Process> others;
    for (unsigned i = 0; i < 2 * static_cast<unsigned>(::sysconf(_SC_NPROCESSORS_ONLN)); ++i)
        others.emplace_back(std::vector<std::string>{"/bin/sh", "-c", "while :; do :; done"},
                            std::vector<std::string>{}, swarm.home() / "others.log");
    Json load;
    CHECK(eventually([&] { return !(load = full()).is_null(); }));
    CHECK_MESSAGE(has(load.dump(), "other programs "), load.dump());
    CHECK(load.at("blocks") == false);
    CHECK(load.at("command") == "hivectl top");  // no drone is to blame
    count("load " + load.at("drone").get<std::string>(), first);
    others.clear();

    swarm.hivectl_done({"set", "source", "fps=50"});
    std::vector<Process> hogs;
    for (int i = 0; i < ::sysconf(_SC_NPROCESSORS_ONLN); ++i) {
        const auto name = "hog" + std::to_string(i);
        hogs.push_back(swarm.drone("sleeper", name, {"burn_ms=100"}));
        swarm.hivectl_done({"connect", "source", name});
    }
    REQUIRE(eventually([&] { return !(load = full("explain")).is_null() && load.at("command") != "hivectl top"; }));
    CHECK_MESSAGE(has(load.at("command").get<std::string>(), "hivectl halt hog"), load.dump());
    CHECK(Shell(swarm).run(load.at("command")).exit_code == 0);
    // The other hogs may be named next, and in the end other programs.
    CHECK(eventually([&] {
        load = full("explain");
        return load.is_null() || load.at("command") == "hivectl top"
               || Shell(swarm).run(load.at("command")).exit_code != 0;
    }));
    CHECK_MESSAGE((load.is_null() || load.at("command") == "hivectl top"), load.dump());
}
