// Drones of another home, reached over TCP by their names: every verb, ambiguous names, places that do not answer.
#include "measure.hpp"
#include "rows.hpp"

#include <mute_server.hpp>

#include <doctest/doctest.h>

#include <list>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// The network address that a drone reports.
std::string port_of(const Swarm& swarm, const std::string& drone)
{
    for (const auto& place : swarm.application().status(drone).places)
        if (place.starts_with("tcp://"))
            return place;
    return {};
}

const std::vector<std::string> on_network{"--listen", "tcp://127.0.0.1", "--insecure"};

Process on_port(const Swarm& swarm, const std::string& kind, const std::string& name,
                const std::vector<std::string>& settings = {})
{
    return swarm.drone(kind, name, settings, on_network);
}

/// Adds the place of another home's drone to the list of one home.
void introduce(const Swarm& there, const std::string& drone, const Swarm& here)
{
    here.hivectl_done({"place", "add", drone, port_of(there, drone)});
}

}  // namespace

TEST_CASE("places: a drone of another home is described, set, halted, looked at and stopped by its name")
{
    const Swarm far, near;
    const auto source = on_port(far, "ticker", "source", {"fps=100"});
    introduce(far, "source", near);
    const auto local = near.drone("sleeper", "worker");

    const auto rows = near.hivectl_done({"ps", "--json", "--timeout", "10"});
    CHECK(row_named(rows, "name", "source").at("host") == "127.0.0.1");
    CHECK(row_named(rows, "name", "source").at("pid") == source.pid());
    CHECK(row_named(rows, "name", "worker").at("host") == "local");
    CHECK(has(near.hivectl_done({"ps"}), "HOST"));
    CHECK(has(near.hivectl_done({"describe", "source"}), "ticker"));
    CHECK(near.hivectl_done({"get", "source", "fps"}) == "100.0\n");
    CHECK(near.hivectl_done({"set", "source", "fps=50"}) == "50.0\n");
    CHECK(far.application().get("source", {"fps"}) == Json{{"fps", 50.0}});
    CHECK(lines_of(near.hivectl_done({"results", "source", "-n", "2"})) == 2);
    CHECK(near.hivectl_done({"halt", "source"}) == "source\n");
    CHECK(near.hivectl_done({"wait", "source", "--for", "halted"}).empty());
    CHECK(near.hivectl_done({"resume", "source"}) == "source\n");
    CHECK(has(near.hivectl_done({"top", "--once", "--interval", "0.05"}), "source"));
    CHECK(near.hivectl_done({"stop", "source"}) == "source\n");
    CHECK(Json::parse(near.hivectl_done({"place", "list", "--json"})).empty());
    CHECK(near.hivectl({"get", "source"}).exit_code == 3);
}

TEST_CASE("places: drones of two homes are connected both ways, and a glob goes over all of them")
{
    const Swarm far, near;
    const auto far_source = on_port(far, "ticker", "far-source", {"fps=200"});
    const auto far_worker = on_port(far, "sleeper", "far-worker");
    const auto near_source = on_port(near, "ticker", "near-source", {"fps=200"});
    const auto near_worker = near.drone("sleeper", "near-worker");
    introduce(far, "far-source", near);
    introduce(far, "far-worker", near);

    near.hivectl_done({"connect", "far-source", "near-worker"});
    near.hivectl_done({"connect", "near-source", "far-worker"});
    CHECK(lines_of(near.hivectl_done({"results", "*-worker", "-n", "6"})) == 6);
    for (const auto* worker : {"near-worker", "far-worker"})
        CHECK_MESSAGE(lines_of(near.hivectl_done({"results", worker, "-n", "2"})) == 2, worker);
    const auto edges = near.hivectl_done({"connections", "--json"});
    CHECK(row_named(edges, "from", "far-source.tick").at("known_by") == "both");
    CHECK(row_named(edges, "from", "near-source.tick").at("to") == "far-worker.image");
    CHECK(lines_of(near.hivectl_done({"set", "*-source", "fps=20"})) == 2);
    CHECK(near.hivectl({"set", "*-source", "fps=-1"}).exit_code == 5);
    CHECK(far.application().get("far-source", {"fps"}) == Json{{"fps", 20.0}});
    near.hivectl_done({"disconnect", "near-source", "far-worker"});
    CHECK(far.application().status("far-worker").inputs.empty());
}

TEST_CASE("places: two drones of one other home meet in that home, without the network between them")
{
    const Swarm far, near;
    const auto source = on_port(far, "ticker", "source", {"fps=100"});
    const auto worker = on_port(far, "sleeper", "worker");
    introduce(far, "source", near);
    introduce(far, "worker", near);
    near.hivectl_done({"connect", "source", "worker"});
    const auto state = text_of(far.home() / "worker.state");
    CHECK_MESSAGE(has(state, "unix:" + far.home().string()), state);
}

TEST_CASE("places: a sender that does not listen on the network is not connected to another home, which is said")
{
    const Swarm far, near;
    const auto worker = on_port(far, "sleeper", "worker");
    const auto source = near.drone("ticker", "source");
    introduce(far, "worker", near);
    const auto refused = near.hivectl({"connect", "source", "worker"});
    CHECK(refused.exit_code == 4);
    CHECK(has(refused.err, "does not listen on the network"));
    CHECK(has(refused.err, "--listen"));
}

TEST_CASE("places: a name that two homes have is refused alone, and NAME@HOST means one of them")
{
    const Swarm far, near;
    const auto other = on_port(far, "ticker", "source", {"fps=10"});
    const auto own = near.drone("ticker", "source", {"fps=20"});
    introduce(far, "source", near);
    const auto several = near.hivectl({"get", "source", "fps"});
    CHECK(several.exit_code == 2);
    CHECK(has(several.err, "source@local"));
    CHECK(has(several.err, "source@127.0.0.1"));
    CHECK(near.hivectl_done({"get", "source@local", "fps"}) == "20.0\n");
    CHECK(near.hivectl_done({"get", "source@127.0.0.1", "fps"}) == "10.0\n");
    CHECK(near.hivectl_done({"stop", "source@127.0.0.1"}) == "source@127.0.0.1\n");
    CHECK(near.hivectl_done({"get", "source", "fps"}) == "20.0\n");
}

TEST_CASE("places: a second drone of a name is not started, and the refusal says where the first one is")
{
    const Swarm far, near;
    const auto first = on_port(far, "ticker", "ticker");
    const auto place = port_of(far, "ticker");
    introduce(far, "ticker", near);
    const auto refused = near.hivectl({"start", "ticker"});
    CHECK(refused.exit_code == near.hivectl({"start", "ticker", "--as", "ticker"}).exit_code);
    CHECK(refused.exit_code != 0);
    CHECK(has(refused.err, place));
    CHECK_FALSE(std::filesystem::exists(near.home() / "ticker.sock"));
}

TEST_CASE("places: one that does not answer is unreachable, costs the others nothing, and its name can be given away")
{
    const Swarm far, near;
    auto lost = on_port(far, "ticker", "lost");
    const auto there = on_port(far, "ticker", "there", {"fps=10"});
    introduce(far, "lost", near);
    introduce(far, "there", near);
    near.hivectl_done({"ps"});
    lost.kill();

    const auto ps = near.hivectl({"ps", "--json", "--timeout", "10"});
    CHECK(ps.exit_code == 0);
    CHECK(row_named(ps.out, "name", "lost").at("state") == "unreachable");
    CHECK(has(row_named(ps.out, "name", "lost").at("note"), "answered "));
    CHECK(row_named(ps.out, "name", "there").at("state") != "unreachable");
    const auto get = near.hivectl({"get", "*", "fps"});
    CHECK(get.exit_code == 8);
    CHECK(has(get.out, "there fps=10"));
    CHECK(near.hivectl({"set", "lost", "fps=5"}).exit_code == 4);
    CHECK(near.hivectl({"stop", "lost"}).exit_code == 4);
    const auto started = near.hivectl({"start", "ticker", "--as", "lost"});
    CHECK_MESSAGE(started.exit_code == 0, started.err);
    CHECK(has(started.err, "its address was removed"));
    CHECK(row_named(near.hivectl_done({"ps", "--json"}), "name", "lost").at("host") == "local");
}

TEST_CASE("places: only what answers by its name is added, once, and can be removed")
{
    const Swarm far, near;
    const auto source = on_port(far, "ticker", "source");
    const auto place = port_of(far, "source");
    CHECK(near.hivectl({"place", "add", "camera", place}).exit_code == 4);
    CHECK(near.hivectl({"place", "add", "source", "tcp://127.0.0.1:1"}).exit_code == 4);
    CHECK(near.hivectl({"place", "add", "source", "127.0.0.1"}).exit_code == 2);
    CHECK(near.hivectl_done({"place", "list", "--json"}) == "[]\n");
    introduce(far, "source", near);
    introduce(far, "source", near);                                        // no harm
    CHECK(far.hivectl({"place", "add", "source", place}).exit_code != 0);  // it is a local drone there
    CHECK(Json::parse(near.hivectl_done({"place", "list", "--json"})).size() == 1);
    CHECK(near.hivectl_done({"place", "remove", "source"}) == "source\n");
    CHECK(near.hivectl({"place", "remove", "source"}).exit_code == 3);
    CHECK(far.application().status("source").pid == source.pid());
}

TEST_CASE("places: a drone of another name that has come to a port is taken for nobody else")
{
    const Swarm far, near;
    const auto worker = near.drone("sleeper", "worker");
    auto source = on_port(far, "ticker", "source", {"fps=100"});
    const auto place = port_of(far, "source");
    introduce(far, "source", near);
    near.hivectl_done({"connect", "source", "worker"});
    source.kill();
    const auto usurper = far.drone("ticker", "usurper", {}, {"--listen", place, "--insecure"});
    const auto answer = near.hivectl({"set", "source", "fps=1"});
    CHECK(answer.exit_code == 4);
    CHECK(has(answer.err, "usurper"));
    auto application = near.application();
    CHECK(eventually([&] { return has(application.status("worker").inputs.at(0).error, "usurper"); }, 10'000ms));
    CHECK_FALSE(application.status("worker").inputs.at(0).connected);
}

TEST_CASE("places: a drone takes its port from 7700 on, and has it again after a crash, with its receivers")
{
    const Swarm far, near;
    const auto worker = near.drone("sleeper", "worker");
    auto source = on_port(far, "ticker", "source", {"fps=100"});
    const auto place = port_of(far, "source");
    const int port = std::stoi(place.substr(place.rfind(':') + 1));
    CHECK(port >= 7700);
    CHECK(port < 7956);
    introduce(far, "source", near);
    near.hivectl_done({"connect", "source", "worker"});
    source.kill();
    const auto again = far.drone("ticker", "source");  // without --listen
    CHECK(port_of(far, "source") == place);
    auto application = near.application();
    CHECK(eventually([&] { return application.status("worker").inputs.at(0).connected; }, 10'000ms));
    CHECK(application.status("source").pid == again.pid());
    far.hivectl_done({"stop", "source"});
    const auto afresh = far.drone("ticker", "source");
    CHECK(port_of(far, "source").empty());
}

TEST_CASE("places: the last of many drones of one machine finds its port about as soon as the first")
{
    const Swarm swarm;
    auto ms_to_begin = [&, number = 0]() mutable {
        const auto name = "source-" + std::to_string(++number);  // none has the port of one before it
        const auto begin = Clock::now();
        const auto drone = on_port(swarm, "ticker", name);
        return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    };
    const auto first = std::min({ms_to_begin(), ms_to_begin(), ms_to_begin()});
    std::list<MuteServer> others;
    for (std::uint16_t port = 7700; port < 7950; ++port)
        others.emplace_back(port);
    const auto most = 3 * first + 30;
    auto last = ms_to_begin();
    for (int more = 0; more < 12 && last >= most; ++more)
        last = std::min(last, ms_to_begin());
    MESSAGE(first, " ms, and behind 250 others ", last, " ms");
    CHECK(last < most);
}

TEST_CASE("replace: the new one has the port of the old one, and its receivers in another home")
{
    const Swarm far, near;
    const auto worker = near.drone("sleeper", "worker");
    const auto source = on_port(far, "ticker", "source", {"fps=100"});
    const auto place = port_of(far, "source");
    introduce(far, "source", near);
    near.hivectl_done({"connect", "source", "worker"});
    auto application = near.application();
    const auto collector = application.collect({{"worker", "result"}});
    REQUIRE(collector->next(patient(10'000ms)));
    const auto elsewhere = near.hivectl({"replace", "source"});
    CHECK(elsewhere.exit_code == 5);
    CHECK(has(elsewhere.err, "on that machine: hivectl replace source"));
    const auto epoch = application.status("source").epoch;
    far.hivectl_done({"replace", "source"}, 40'000ms);
    CHECK(port_of(far, "source") == place);
    const auto begin = Clock::now();
    std::optional<hive::Event> event;
    do
        event = collector->next(patient(10'000ms));
    while (event && event->identity.epoch <= epoch && Clock::now() - begin < patient(10'000ms));
    REQUIRE(event);
    CHECK(event->identity.epoch > epoch);
}

TEST_CASE("places: what is advertised is where others are told to find it")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {},
                                    {"--listen", "tcp://127.0.0.1", "--advertise", "tcp://localhost", "--insecure"});
    CHECK(port_of(swarm, "source").starts_with("tcp://localhost:77"));
    const auto nowhere = swarm.run({swarm.program("hive-ticker").string(), "--name", "other", "--listen",
                                    "tcp://127.0.0.1", "--advertise", "tcp://0.0.0.0:7700", "--insecure"});
    CHECK(nowhere.exit_code == 2);
    CHECK(has(nowhere.err, "--advertise"));
}
