// Drones of another home, met over TCP by their names: every verb, names that are not unique, places that do not
// answer.
#include "measure.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Where a drone listens on the network, as it says itself.
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

/// Writes into the list of one home where the drone of another is.
void introduce(const Swarm& there, const std::string& drone, const Swarm& here)
{
    here.hivectl_done({"place", "add", drone, port_of(there, drone)});
}

Json row_named(const std::string& rows, const std::string& key, const std::string& name)
{
    for (const auto& row : Json::parse(rows))
        if (row.at(key) == name)
            return row;
    return nullptr;
}

std::ptrdiff_t lines_of(const std::string& text) { return std::ranges::count(text, '\n'); }

}  // namespace

TEST_CASE("places: a drone of another home is described, set, halted, looked at and stopped by its name")
{
    const Swarm far, near;
    const auto source = on_port(far, "ticker", "source", {"fps=100"});
    introduce(far, "source", near);
    const auto local = near.drone("sleeper", "worker");

    const auto rows = near.hivectl_done({"ps", "--json"});
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
    const auto edges = near.hivectl_done({"edges", "--json"});
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

    const auto ps = near.hivectl({"ps", "--json"});
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
    CHECK(has(started.err, "forgotten"));
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
    CHECK(far.hivectl({"place", "add", "source", place}).exit_code != 0);  // it is at home there
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
    const auto again = far.drone("ticker", "source");  // it is not told to listen
    CHECK(port_of(far, "source") == place);
    auto application = near.application();
    CHECK(eventually([&] { return application.status("worker").inputs.at(0).connected; }, 10'000ms));
    CHECK(application.status("source").pid == again.pid());
    far.hivectl_done({"stop", "source"});
    const auto afresh = far.drone("ticker", "source");
    CHECK(port_of(far, "source").empty());
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

TEST_CASE("logs: the last lines of a drone, also of one that has crashed")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "ticker"});
    CHECK(has(swarm.hivectl_done({"logs", "ticker"}), "started"));
    CHECK(lines_of(swarm.hivectl_done({"logs", "ticker", "-n", "1", "--json"})) == 1);
    ::kill(static_cast<pid_t>(swarm.application().status("ticker").pid), SIGKILL);
    CHECK(has(swarm.hivectl_done({"logs", "ticker"}), "started"));
    CHECK(swarm.hivectl({"logs", "nobody"}).exit_code == 3);
}

namespace {

/// A program called ssh that finds one machine: the other home. It keeps to the few words that hivectl says to ssh.
class FakeSsh {
public:
    FakeSsh(const Swarm& here, const Swarm& there)
        : here_(here), directory_(here.home() / "ssh"), path_(directory_.string() + ":" + std::getenv("PATH"))
    {
        std::filesystem::create_directory(directory_);
        const auto file = directory_ / "ssh";
        std::ofstream(file) << "#!/bin/sh\n"
                               "if [ \"$1\" = -G ]; then echo hostname 127.0.0.1; exit; fi\n"
                               "while [ \"$1\" != -- ]; do shift; done\n"
                               "case $2 in\n"
                               "  me@gpu1) HIVE_HOME="
                            << there.home().string() << " PATH=" << there.program("hivectl").parent_path().string()
                            << ":$PATH exec sh -c \"$3\" ;;\n"
                            << "  bare) PATH=/nowhere exec /bin/sh -c \"$3\" ;;\n"
                               "esac\n"
                               "echo 'ssh: Could not resolve hostname '$2 >&2\n"
                               "exit 255\n";
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    [[nodiscard]] Finished hivectl(const std::vector<std::string>& words) const
    {
        std::vector<std::string> all{"/usr/bin/env", "PATH=" + path_, here_.program("hivectl").string()};
        all.insert(all.end(), words.begin(), words.end());
        return here_.run(all, 40'000ms);
    }

private:
    const Swarm& here_;
    std::filesystem::path directory_;
    std::string path_;
};

}  // namespace

TEST_CASE("start --on: the drone runs there, is in the list of places until it is stopped, and its log is read")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto started = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "fps=7", "--insecure"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    CHECK(started.out == "t-1\n");
    CHECK(there.application().get("t-1", {"fps"}) == Json{{"fps", 7.0}});
    CHECK(row_named(here.hivectl_done({"ps", "--json"}), "name", "t-1").at("host") == "gpu1");
    const auto places = Json::parse(here.hivectl_done({"place", "list", "--json"}));
    REQUIRE(places.size() == 1);
    CHECK(places.at(0).at("ssh") == "me@gpu1");
    CHECK(has(ssh.hivectl({"logs", "t-1"}).out, "listening at tcp://"));
    const auto again = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--as", "t-1", "--insecure"});
    CHECK(again.exit_code != 0);
    CHECK(has(again.err, "gpu1"));
    CHECK(ssh.hivectl({"stop", "t-1"}).out == "t-1\n");
    CHECK(there.application().drones().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start --on: a drone that crashed there is forgotten there by stop, and its last words can be read")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    REQUIRE(ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--insecure"}).exit_code == 0);
    ::kill(static_cast<pid_t>(there.application().status("ticker").pid), SIGKILL);
    REQUIRE(eventually([&] { return there.application().drones().empty(); }));
    CHECK(row_named(here.hivectl_done({"ps", "--json"}), "name", "ticker").at("state") == "unreachable");
    CHECK(has(ssh.hivectl({"logs", "ticker"}).out, "started"));
    CHECK(there.application().remembered() == std::vector<std::string>{"ticker"});
    const auto stopped = ssh.hivectl({"stop", "ticker"});
    CHECK_MESSAGE(stopped.exit_code == 0, stopped.err);
    CHECK(there.application().remembered().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start --on: what is missing there is said in one sentence, with what helps")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    const auto unknown_host = ssh.hivectl({"start", "ticker", "--on", "nobody", "--insecure"});
    CHECK(unknown_host.exit_code == 4);
    CHECK(has(unknown_host.err, "Could not resolve hostname nobody"));
    CHECK(has(unknown_host.err, "ssh nobody true"));
    const auto no_hivectl = ssh.hivectl({"start", "ticker", "--on", "bare", "--insecure"});
    CHECK(no_hivectl.exit_code == 3);
    CHECK(has(no_hivectl.err, "no hivectl on bare"));
    const auto no_drone = ssh.hivectl({"start", "nothing-like-it", "--on", "me@gpu1", "--insecure"});
    CHECK(no_drone.exit_code == 3);
    CHECK(has(no_drone.err, "gpu1: there is no drone hive-nothing-like-it"));
    const auto no_key = ssh.hivectl({"start", "ticker", "--on", "me@gpu1"});
    CHECK(no_key.exit_code != 0);
    CHECK(has(no_key.err, "gpu1: "));
    const auto bad_value = ssh.hivectl({"start", "ticker", "--on", "me@gpu1", "--insecure", "fps=none at all'"});
    CHECK(bad_value.exit_code != 0);
    CHECK(has(bad_value.err, "fps"));
    CHECK(ssh.hivectl({"start", "ticker", "--on", "-oProxyCommand=touch x"}).exit_code == 2);
    CHECK(there.application().drones().empty());
    CHECK(here.hivectl_done({"place", "list", "--json"}) == "[]\n");
}

TEST_CASE("start --on: what concerns its machine is set through ssh, and by the swarm's key alone it is not")
{
    const Swarm there, here;
    const FakeSsh ssh(here, there);
    here.hivectl_done({"key", "new"});
    const auto started = ssh.hivectl({"start", "camera", "--on", "me@gpu1", "--json"});
    REQUIRE_MESSAGE(started.exit_code == 0, started.err);
    const auto set = ssh.hivectl({"set", "camera", "source=scene", "fps=7"});
    CHECK_MESSAGE(set.exit_code == 0, set.err);
    CHECK(set.out == "fps=7.0\nsource=scene\n");
    CHECK(there.application().get("camera", {"fps"}) == Json{{"fps", 7.0}});
    const auto bad = ssh.hivectl({"set", "camera", "source=/nowhere/it's not there"});
    CHECK(bad.exit_code != 0);
    CHECK(has(bad.err, "gpu1: "));

    const auto address = Json::parse(started.out).at("address").get<std::string>();
    here.hivectl_done({"place", "remove", "camera"});
    here.hivectl_done({"place", "add", "camera", address});
    const auto by_key = ssh.hivectl({"set", "camera", "source=scene"});
    CHECK(by_key.exit_code == 5);
    CHECK(has(by_key.err, "--remote-operator"));
    CHECK(ssh.hivectl({"set", "camera", "fps=8"}).exit_code == 0);
    there.hivectl_done({"stop", "camera"});
}
