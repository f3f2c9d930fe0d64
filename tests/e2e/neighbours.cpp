// Drones discovered on the local network, with the real daemons: namespaces on a bridge, each with a system bus and an
// Avahi daemon. Without these the tests are skipped.
#include "lan.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <map>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

using Words = std::vector<std::string>;

Json rows(const Neighbour& machine) { return Json::parse(machine.hivectl({"ps", "--json"})); }

std::vector<Json> rows_named(const Neighbour& machine, const std::string& name)
{
    std::vector<Json> found;
    for (const auto& row : rows(machine))
        if (row.at("name") == name)
            found.push_back(row);
    return found;
}

/// Is it shown once, and does it answer?
bool shows(const Neighbour& machine, const std::string& name, const std::string& host)
{
    const auto found = rows_named(machine, name);
    return found.size() == 1 && found[0].at("host") == host && found[0].at("pid").is_number();
}

bool shows_nothing_of(const Neighbour& machine, const std::string& name) { return rows_named(machine, name).empty(); }

Words start(const std::string& kind, const Words& more = {})
{
    Words words{"start", kind, "--listen", "tcp://0.0.0.0"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// Machines of one swarm, with their daemons.
void begin(const Lan& lan, const std::vector<std::size_t>& machines)
{
    for (const auto i : machines) {
        lan.share_key(lan[i].swarm());
        lan[i].start_daemon();
    }
    for (const auto i : machines)
        lan[i].await_daemon();
}

pid_t pid_of(const Neighbour& machine, const std::string& name)
{
    return rows_named(machine, name).at(0).at("pid").get<pid_t>();
}

}  // namespace

TEST_CASE("neighbours: a drone of another machine is found by its name alone, and every verb works on it")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1"});
    begin(lan, {0, 1});
    auto &laptop = lan[0], &cam1 = lan[1];
    laptop.hivectl({"start", "sleeper"});
    auto waiting = laptop.hivectl_running({"wait", "ticker", "--timeout", "30"}, "wait");
    cam1.hivectl(start("ticker", {"fps=50"}));
    CHECK_MESSAGE(waiting.wait(patient(30'000ms)) == 0, laptop.swarm().log("wait"));  // it is notified of new ones
    REQUIRE(eventually([&] { return shows(laptop, "ticker", "cam1"); }, 10'000ms));
    CHECK(shows(cam1, "ticker", "local"));  // announced, and still there once
    CHECK(laptop.hivectl({"place", "list", "--json"}) == "[]\n");
    CHECK(laptop.hivectl({"get", "ticker", "fps"}) == "50.0\n");
    CHECK(laptop.hivectl({"get", "ticker@cam1", "fps"}) == "50.0\n");
    laptop.hivectl({"set", "ticker", "fps=40"});
    CHECK(laptop.hivectl({"get", "tick*", "fps", "--json"}).find("40.0") != std::string::npos);
    laptop.hivectl({"connect", "ticker", "sleeper"});
    CHECK(has(laptop.hivectl({"results", "ticker.tick", "-n", "1"}), "\"seq\""));
    const auto edge = Json::parse(laptop.hivectl({"connections", "sleeper", "--json"})).at(0);
    CHECK(edge.at("from_host") == "cam1");
    CHECK(edge.at("to_host") == "local");
    const auto second = laptop.run({"hivectl", "start", "ticker"});
    CHECK(second.exit_code != 0);
    CHECK_MESSAGE(has(second.err, "ticker is running already, at tcp://" + cam1.address()), second.err);
    laptop.hivectl({"place", "add", "ticker", "tcp://" + cam1.address() + ":7700"});
    CHECK(shows(laptop, "ticker", cam1.address()));  // the list has its name here
    laptop.hivectl({"place", "remove", "ticker"});
    laptop.hivectl({"stop", "--all"});
    CHECK(shows_nothing_of(laptop, "sleeper"));
    CHECK(eventually([&] { return shows(laptop, "ticker", "cam1"); }));  // it is not of this home
    laptop.hivectl({"stop", "ticker"});
    CHECK(eventually([&] { return shows_nothing_of(laptop, "ticker"); }, 10'000ms));
}

TEST_CASE("neighbours: drones of another key, without a key, or told not to announce themselves are not shown")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1"});
    begin(lan, {0, 1});
    auto &laptop = lan[0], &cam1 = lan[1];
    const Swarm stranger;
    stranger.hivectl_done({"key", "new"});
    cam1.hivectl_in(stranger, start("ticker", {"--as", "stranger"}));
    cam1.hivectl_in(stranger, start("ticker", {"--as", "late"}));
    cam1.hivectl_in(stranger, start("ticker", {"--as", "open", "--insecure"}));
    cam1.hivectl({"start", "ticker", "--as", "quiet", "--no-announce", "--listen", "tcp://0.0.0.0:7790"});
    const Swarm neighbour;  // another home of the same machine and swarm
    lan.share_key(neighbour);
    cam1.hivectl_in(neighbour, start("ticker", {"--as", "late"}));
    REQUIRE(eventually([&] { return shows(laptop, "late", "cam1"); }, 10'000ms));
    REQUIRE(eventually([&] { return has(stranger.log("stranger"), "announced on"); }, 10'000ms));
    CHECK(rows(laptop).size() == 1);
    CHECK(eventually([&] { return shows(cam1, "late", "cam1"); }));
    CHECK_FALSE(has(stranger.log("open"), "announced"));
    CHECK_FALSE(has(cam1.swarm().log("quiet"), "announced"));
    laptop.hivectl({"place", "add", "quiet", "tcp://" + cam1.address() + ":7790"});
    CHECK(shows(laptop, "quiet", cam1.address()));
    std::ofstream(stranger.key_file()) << text_of(laptop.swarm().key_file());  // its drones have the new key at once
    CHECK(eventually([&] { return shows(laptop, "stranger", "cam1"); }, 10'000ms));
    CHECK(eventually([&] {  // two of them now, on one machine
        return std::ranges::count_if(rows(laptop), [](const Json& row) { return has(row.at("name"), "late@cam1:"); })
               == 2;
    }));
}

TEST_CASE("neighbours: what becomes of a drone and its daemon when they die, and come back")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1"});
    begin(lan, {0, 1});
    auto &laptop = lan[0], &cam1 = lan[1];
    cam1.hivectl(start("ticker"));
    cam1.hivectl(start("sleeper"));
    REQUIRE(eventually([&] { return shows(laptop, "ticker", "cam1") && shows(laptop, "sleeper", "cam1"); }, 10'000ms));

    ::kill(pid_of(laptop, "ticker"), SIGKILL);
    CHECK(eventually([&] { return shows_nothing_of(laptop, "ticker"); }, 5'000ms));
    CHECK(eventually([&] { return shows(laptop, "sleeper", "cam1"); }));
    cam1.hivectl({"start", "ticker", "--listen", "tcp://0.0.0.0:7733"});
    REQUIRE(eventually([&] { return shows(laptop, "ticker", "cam1"); }, 10'000ms));
    CHECK(has(laptop.hivectl({"describe", "ticker", "--json"}), "\"ticker\""));

    cam1.kill_daemon();
    CHECK(shows(cam1, "ticker", "local"));
    cam1.start_daemon();
    CHECK(eventually([&] { return shows(laptop, "ticker", "cam1") && shows(laptop, "sleeper", "cam1"); }, 15'000ms));

    laptop.kill_daemon();
    CHECK(rows(laptop).empty());
    laptop.start_daemon();
    CHECK(eventually([&] { return shows(laptop, "ticker", "cam1"); }, 15'000ms));
}

TEST_CASE("neighbours: a machine that has vanished, and a daemon or a bus that hangs, hold up nobody")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1", "cam2"});
    begin(lan, {0, 1, 2});
    auto &laptop = lan[0], &cam1 = lan[1];
    cam1.hivectl(start("ticker"));
    lan[2].hivectl(start("sleeper"));
    laptop.hivectl(start("counter"));
    REQUIRE(eventually([&] { return shows(laptop, "ticker", "cam1") && shows(laptop, "sleeper", "cam2"); }, 10'000ms));
    const auto took = [&](const Words& words) {
        const auto begin = Clock::now();
        laptop.hivectl(words);
        return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
    };
    for (const bool whole_bus : {false, true}) {
        whole_bus ? laptop.signal_bus(SIGSTOP) : laptop.signal_daemon(SIGSTOP);
        CHECK(took({"ps"}) < patient(4'000ms));
        CHECK(shows(laptop, "counter", "local"));
        CHECK(took({"halt", "counter"}) < patient(4'000ms));
        CHECK(took(start("face", {"--as", whole_bus ? "second" : "first"})) < patient(8'000ms));
        CHECK(took({"stop", whole_bus ? "second" : "first", "counter"}) < patient(4'000ms));
        whole_bus ? laptop.signal_bus(SIGCONT) : laptop.signal_daemon(SIGCONT);
        laptop.hivectl(start("counter"));
    }
    CHECK(eventually([&] { return shows(lan[2], "counter", "laptop"); }, 15'000ms));
    laptop.hivectl({"ps"});  // which records that it has listened
    cam1.cut();
    const auto at = Clock::now();
    std::map<std::string, std::string> states;
    for (const auto& row : rows(laptop))
        states[row.at("name")] = row.at("state");
    CHECK(Clock::now() - at < patient(4'000ms));
    CHECK((!states.contains("ticker") || states["ticker"] == "unreachable"));  // until the daemon here detects it
    CHECK(states["sleeper"] == "idle");
    CHECK(states["counter"] == "idle");
}

TEST_CASE("neighbours: two drones of one name on two machines are called by their hosts")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1", "cam2"});
    for (const std::size_t i : {0, 1, 2})
        lan.share_key(lan[i].swarm());
    for (const std::size_t i : {1, 2})  // before they can discover each other
        lan[i].hivectl(start("ticker", {"fps=" + std::to_string(10 * i)}));
    for (const std::size_t i : {0, 1, 2})
        lan[i].start_daemon();
    auto& laptop = lan[0];
    const auto both = [&] { return shows(laptop, "ticker@cam1", "cam1") && shows(laptop, "ticker@cam2", "cam2"); };
    REQUIRE(eventually(both, 15'000ms));
    CHECK(laptop.hivectl({"get", "ticker@cam1", "fps"}) == "10.0\n");
    CHECK(laptop.hivectl({"get", "ticker@cam2", "fps"}) == "20.0\n");
    const auto which = laptop.run({"hivectl", "get", "ticker"});
    CHECK(which.exit_code != 0);
    CHECK_MESSAGE(has(which.err, "ticker@cam2"), which.err);
    CHECK(lan[1].hivectl({"get", "ticker", "fps"}) == "10.0\n");  // the nearest
}

namespace {

/// One file of services for the stranger's daemon.
void announce_falsely(const Neighbour& stranger, int number, const Words& txt)
{
    std::ofstream file(stranger.services() / ("false-" + std::to_string(number) + ".service"));
    file << "<?xml version=\"1.0\"?><!DOCTYPE service-group SYSTEM \"avahi-service.dtd\"><service-group><name>false "
         << number << "</name><service><type>_hive._tcp</type><port>" << 7000 + number << "</port>";
    for (const auto& text : txt)
        file << "<txt-record>" << text << "</txt-record>";
    file << "</service></service-group>\n";
}

/// The announcement of a drone, as any machine on the network can read it.
Words txt_of(const Neighbour& machine, const std::string& drone)
{
    const auto seen = machine.run({"avahi-browse", "-rpt", "_hive._tcp"}).out;
    Words txt;
    for (auto from = seen.find("=;lan"); from != std::string::npos; from = seen.find("=;lan", from + 1)) {
        const auto line = seen.substr(from, seen.find('\n', from) - from);
        if (!has(line, "\"name=" + drone + "\""))
            continue;
        for (auto quote = line.find('"'); quote != std::string::npos; quote = line.find('"', quote + 1)) {
            const auto end = line.find('"', quote + 1);
            txt.push_back(line.substr(quote + 1, end - quote - 1));
            quote = end;
        }
    }
    return txt;
}

/// A daemon that answers correctly but slowly: it runs only part of the time.
class Slowed {
public:
    Slowed(const Neighbour& machine, Milliseconds pause)
        : machine_(machine), thread_([this, pause](const std::stop_token& ending) {
              while (!ending.stop_requested()) {
                  machine_.signal_daemon(SIGSTOP);
                  std::this_thread::sleep_for(pause);
                  machine_.signal_daemon(SIGCONT);
                  std::this_thread::sleep_for(500us);
              }
          })
    {
    }

private:
    const Neighbour& machine_;
    std::jthread thread_;
};

}  // namespace

TEST_CASE("neighbours: a hundred false announcements of a stranger show nothing and cost next to nothing")
{
    if (!possible(missing_for_lan()))
        return;
    const Lan lan({"laptop", "cam1", "stranger"});
    auto &laptop = lan[0], &cam1 = lan[1], &stranger = lan[2];
    begin(lan, {0, 1});
    cam1.hivectl(start("ticker"));
    REQUIRE(eventually([&] { return shows(laptop, "ticker", "cam1"); }, 10'000ms));
    const auto genuine = txt_of(laptop, "ticker");
    if (genuine.empty())
        MESSAGE("no avahi-browse: what is genuine is not repeated");
    const std::string digits(32, 'a');
    const std::vector<Words> kinds{
        genuine,  // from another machine and port
        {"txtvers=1", "name=ticker", "kind=ticker", "epoch=1", "key=" + digits, "proof=" + digits, "members=" + digits},
        {"txtvers=1", "name=../../x", "kind=x", "epoch=1", "key=" + digits, "proof=" + digits, "members=" + digits},
        {"txtvers=1", "name=" + std::string(200, 'n'), "kind=" + std::string(200, 'k'), "epoch=999999999999999999999"},
        {"txtvers=1", "name=x", "kind=x", "epoch=1", "key=" + std::string(240, ','), "proof=" + std::string(240, ','),
         "members=" + digits},
        Words(60, std::string(200, 'z')),
        {},
        {"txtvers=1",
         "name=\xc2\x9b"
         "31mred",
         "kind=x", "epoch=1", "key=" + digits, "proof=" + digits, "members=" + digits, "at=tcp://-oProxyCommand=x:1"},
    };
    for (int i = 0; i < 100; ++i)
        announce_falsely(stranger, i, kinds[static_cast<std::size_t>(i) % kinds.size()]);
    const auto time_of_ps = [&] {
        const auto done = laptop.run({"hivectl", "ps", "--json"});
        CHECK(done.exit_code == 0);
        return done.took;
    };
    const auto before = std::min({time_of_ps(), time_of_ps(), time_of_ps()});
    stranger.start_daemon();
    const auto arrived = [&] { return has(laptop.run({"avahi-browse", "-pt", "_hive._tcp"}).out, "false\\03299"); };
    if (!genuine.empty())
        REQUIRE(eventually(arrived, 15'000ms));
    const auto only_ticker = [&] {  // or nothing, if the daemon must query again while both cores are busy
        const auto all = rows(laptop);
        for (const auto& row : all)
            CHECK_MESSAGE(row.at("name") == "ticker", all.dump());
        return all.size() == 1 && all[0].at("host") == "cam1" && all[0].at("pid").is_number();
    };
    CHECK(eventually(only_ticker));
    CHECK(eventually([&] { return laptop.run({"hivectl", "get", "ticker", "fps"}).out == "30.0\n"; }));
    const auto after = std::min({time_of_ps(), time_of_ps(), time_of_ps()});
    MESSAGE("hivectl ps: " << before.count() << " us before, " << after.count() << " us with a hundred strangers");
    CHECK(after < before + patient(500ms));

    std::size_t looks = 0;
    const auto shown_after_more_than_a_second = [&] {
        const std::vector pauses{10ms, 20ms, 5ms, 2ms};
        const Slowed slowed(laptop, pauses[looks++ % pauses.size()]);
        const auto begin = Clock::now();
        return only_ticker() && Clock::now() - begin > 1s;
    };
    CHECK(eventually(shown_after_more_than_a_second, 20'000ms));
}
