// What a drone uses when nobody asks anything of it, and after many came and went.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <thread>
#include <unistd.h>

using subject::Milliseconds;
using subject::within;

namespace {

/// User and system time of a process so far.
Milliseconds processor_time(pid_t pid)
{
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string text{std::istreambuf_iterator<char>(file), {}};
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::string skipped;
    for (int i = 0; i < 11; ++i)
        fields >> skipped;
    long user = 0, system = 0;
    fields >> user >> system;
    return Milliseconds((user + system) * 1000 / ::sysconf(_SC_CLK_TCK));
}

std::size_t threads(pid_t pid)
{
    const auto tasks = std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task");
    return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

}  // namespace

TEST_CASE(
    "drone: one that has nothing to do uses less than 2 % of a core, a source with one small frame per second 4 %")
{
    const subject::Home home;
    const auto process = home.start();
    auto peer = home.meet();
    // A halted source goes on, and drawing is not what is measured.
    bool is_source = false;
    const hive::Json little{{"fps", 1}, {"width", 160}, {"height", 120}};
    for (const auto& parameter : subject::description().at("parameters"))
        if (const auto name = parameter.at("name").get<std::string>(); little.contains(name)) {
            REQUIRE(raw::error_of(peer.ask(raw::set, {{"parameters", {{name, little.at(name)}}}})) == "");
            is_source = true;
        }
    REQUIRE(raw::error_of(peer.ask(raw::halt)) == "");
    peer.next(Milliseconds(500));  // the start is over
    const double most = hive::test::sanitized() ? 20 : is_source ? 4 : 2;
    double least = 100;
    for (int i = 0; i < 6 && least >= most; ++i) {  // what the start took does not come again
        const auto before = processor_time(process.pid());
        const auto begin = hive::test::Clock::now();
        peer.next(Milliseconds(2500));
        const auto used = processor_time(process.pid()) - before;
        const auto passed = std::chrono::duration_cast<Milliseconds>(hive::test::Clock::now() - begin);
        MESSAGE("used " << used.count() << " ms of " << passed.count());
        least = std::min(least, 100.0 * static_cast<double>(used.count()) / static_cast<double>(passed.count()));
    }
    CHECK(least < most);
}

TEST_CASE("drone: descriptors and threads do not grow over 100 peers that come and go")
{
    const subject::Home home;
    const auto process = home.start();
    for (int i = 0; i < 5; ++i)
        home.meet().ask(raw::status);
    std::this_thread::sleep_for(Milliseconds(300));  // the last of them is gone
    const auto descriptors = hive::test::open_descriptors(process.pid()), tasks = threads(process.pid());
    for (int i = 0; i < 100; ++i)
        REQUIRE(raw::error_of(home.meet().ask(i % 2 ? raw::status : raw::describe)) == "");
    CHECK(hive::test::eventually([&] { return hive::test::open_descriptors(process.pid()) <= descriptors; },
                                 within(2000)));
    CHECK(threads(process.pid()) <= tasks);
}
