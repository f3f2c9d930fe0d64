// Mistakes in swarm files: each is found, where it is, and with what to do about it.
#include <hive/swarm_plan.hpp>

#include <doctest/doctest.h>

#include <chrono>

using namespace hive;

namespace {

ParameterInfo number(const std::string& name, double least, double most)
{
    ParameterInfo info;
    info.name = name;
    info.type = ParameterType::number;
    info.least = least;
    info.most = most;
    return info;
}

ParameterInfo text(const std::string& name)
{
    ParameterInfo info;
    info.name = name;
    return info;
}

Interface camera()
{
    return {.kind = "camera",
            .summary = {},
            .version = {},
            .inputs = {},
            .outputs = {{"image",
                         "image/jpeg,image/png,image/raw",
                         "",
                         {{"jpeg", "image/jpeg", 1, 100}, {"png", "image/png"}, {"raw", "image/raw"}}}},
            .parameters = {number("fps", 0, 1000), text("source")}};
}

Interface face()
{
    return {.kind = "face",
            .summary = {},
            .version = {},
            .inputs = {{"image", "image/jpeg,image/png,image/raw", ""}},
            .outputs = {{"faces", "application/json", ""}, {"annotated", "image/jpeg", ""}},
            .parameters = {number("scale", 1.01, 2)}};
}

Interface track()
{
    auto interface = face();
    interface.kind = "track";
    interface.stateful = true;
    return interface;
}

Interface known(const std::string& kind)
{
    for (const auto& interface : {camera(), face(), track()})
        if (interface.kind == kind)
            return interface;
    throw Error(Errc::not_found, "there is no drone hive-" + kind, "build it");
}

/// "LINE:COLUMN: text; advice", a line each.
std::string mistakes(const std::string& text, const InterfaceOfKind& interface_of = {},
                     const SwarmContext& context = {})
{
    std::string lines;
    for (const auto& mistake : read_swarm(text, interface_of, context).mistakes)
        lines += std::to_string(mistake.line) + ":" + std::to_string(mistake.column) + ": " + mistake.text
                 + (mistake.advice.empty() ? "" : "; " + mistake.advice) + "\n";
    return lines;
}

/// A file whose drones are these lines, and then whatever else.
std::string with(const std::string& drones, const std::string& rest = "")
{
    return "{\"swarm\": \"s\", \"drones\": {\n" + drones + "\n}" + (rest.empty() ? "" : ",\n" + rest) + "}";
}

/// Of any kind, without ports and parameters.
Interface any(const std::string& kind)
{
    Interface interface;
    interface.kind = kind;
    return interface;
}

const std::string two = "\"camera\": {\"kind\": \"camera\"}, \"face\": {\"kind\": \"face\"}";

}  // namespace

TEST_CASE("swarm file: what it says")
{
    const auto reading = read_swarm(R"({
      "swarm": "doorway",
      "drones": {
        "zoom": {"kind": "camera", "on": "cam1", "set": {"fps": 30}, "listen": "tcp://0.0.0.0:7700",
                 "log_level": "debug"},
        "face": {"kind": "face", "count": 3, "on": ["gpu1", "gpu2"], "restart": "on-failure", "on_exception": "halt"}
      },
      "connections": [
        {"from": "zoom.image", "to": "face-*", "share": true, "window": 2, "lease": 1.5},
        {"from": "zoom", "to": ["face-1.image"], "notify": true}
      ],
      "engines": {"cam1": {"ssh": "lab-cam1"}, "gpu*": {"slurm": {"partition": "gpu"}}}
    })");
    REQUIRE(reading.mistakes.empty());
    const auto& plan = reading.plan;
    CHECK_EQ(plan.name, "doorway");
    REQUIRE_EQ(plan.drones.size(), 4u);
    CHECK_EQ(plan.drones[0], SwarmDrone{.name = "zoom",
                                        .kind = "camera",
                                        .host = "cam1",
                                        .set = {{"fps", 30}},
                                        .listen = "tcp://0.0.0.0:7700",
                                        .log_level = "debug"});
    CHECK_EQ(plan.drones[3].name, "face-3");
    CHECK_EQ(plan.drones[3].host, "gpu1");
    CHECK_EQ(plan.drones[2].host, "gpu2");
    CHECK_EQ(plan.drones[2].restart, Restart::on_failure);
    REQUIRE_EQ(plan.connections.size(), 4u);
    using namespace std::chrono_literals;
    const ConnectionOptions shared{.window = 2, .group = "zoom", .lease = 1500ms};
    CHECK(plan.connections[1] == SwarmConnection{{"zoom", "image"}, {"face-2", ""}, shared});
    CHECK(plan.connections[3]
          == SwarmConnection{{"zoom", ""}, {"face-1", "image"}, {.delivery = Delivery::notification}});
    CHECK(plan.engine_of("gpu7") == SwarmEngine{"slurm", {{"partition", "gpu"}}});
    CHECK(plan.engine_of("cam1") == SwarmEngine{"ssh", "lab-cam1"});
    CHECK(plan.engine_of("cam2") == SwarmEngine{"ssh", "cam2"});
    CHECK(plan.engine_of(Place::here) == SwarmEngine{"local", Json::object()});
    CHECK_EQ(plan.drone("face-2"), &plan.drones[2]);
    CHECK_EQ(plan.drone("face"), nullptr);
}

TEST_CASE("swarm file: what is no JSON is said where it is")
{
    CHECK_EQ(mistakes("{\n  # the camera\n}"), "2:3: comments start with // and end with the line\n");
    CHECK_EQ(mistakes("{\"swarm\": \"s\", /* */ \"drones\": {}}"),
             "1:16: comments start with // and end with the line\n");
    CHECK_EQ(mistakes("{\"swarm\": \"s\",\n \"drones\": {},\n}"),
             "3:1: a comma before }; there is none behind the last one of a list\n");
    CHECK_EQ(mistakes("{\"swarm\": \"s\""), "1:14: unexpected end of file; close every { and [\n");
    CHECK_EQ(mistakes("{'swarm': 's'}"), "1:2: JSON strings take \"double\" quotes\n");
    CHECK_EQ(mistakes("{\"a\": 1, \"\xC3\xA4\xC3\xB6\": 2, \"a\": 3}"), "1:19: JSON with duplicate key \"a\"\n");
    CHECK_EQ(mistakes("\xEF\xBB\xBF{}"), "1:1: JSON with a byte order mark\n");
    CHECK_EQ(mistakes(std::string("{}\n \0", 5)), "2:2: JSON with a NUL byte\n");
    CHECK_EQ(mistakes("{\"swarm\" \"s\"}"), "1:10: JSON with unexpected input\n");
    CHECK_EQ(mistakes("{} {}"), "1:4: JSON with unexpected input\n");
    CHECK_EQ(mistakes(std::string(17, '[')), "1:17: JSON with more than 16 levels\n");
    CHECK_EQ(mistakes(""), "1:1: unexpected end of file; close every { and [\n");
}

TEST_CASE("swarm file: every mistake is told, in the order of the file, with the place of its key or value")
{
    CHECK_EQ(
        mistakes(R"({"swarm": "a b", "drones": {
  "camera": {"kind": "camera", "cuont": 2, "on": 3},
  "face": {"kind": "face", "count": "four"},
  "-x": {"kind": "face"}
}, "conections": []})"),
        "1:11: \"a b\" is not a name for a swarm; use 1 to 58 letters, digits, '_', '.' or '-', starting with a letter "
        "or digit\n"
        "2:32: a drone has no key \"cuont\"; did you mean \"count\"?\n"
        "2:50: \"on\" must be a text or a list of texts, not 3\n"
        "3:37: \"count\" must be a whole number from 1 to 1000, not \"four\"\n"
        "4:3: \"-x\" is not a drone name: 1 to 64 letters, digits, '_', '.' or '-', starting with a letter or digit\n"
        "5:4: a swarm file has no key \"conections\"; did you mean \"connections\"?\n");
}

TEST_CASE("swarm file: the path of a mistake")
{
    const auto found = read_swarm(with("\"a\": {\"kind\": \"k\", \"set\": {\"x\": []}}",
                                       "\"connections\": [{\"from\": \"a\", \"to\": [\"a\", 1]}]"))
                           .mistakes;
    REQUIRE_EQ(found.size(), 3u);
    CHECK_EQ(found[0].at, "drones.a.set.x");
    CHECK_EQ(found[1].at, "connections[0].to[0]");
    CHECK_EQ(found[2].at, "connections[0].to[1]");
}

TEST_CASE("swarm file: names that two drones have, and references that nobody has")
{
    CHECK_EQ(mistakes(with("\"a-2\": {\"kind\": \"k\"},\n\"a\": {\"kind\": \"k\", \"count\": 2}")),
             "3:1: two drones are called a-2; the other one comes from drones.a-2\n");
    const auto connection = [](const std::string& from, const std::string& to) {
        return mistakes(with("\"camera\": {\"kind\": \"c\"}, \"face\": {\"kind\": \"f\", \"count\": 2}",
                             "\"connections\": [{\"from\": \"" + from + "\", \"to\": \"" + to + "\"}]"));
    };
    CHECK_EQ(connection("camera", "face-*"), "");
    CHECK_EQ(connection("camera.image", "face-*.image"), "");
    CHECK_EQ(connection("camra", "face-1"), "4:26: there is no drone \"camra\" in this file; did you mean camera?\n");
    CHECK_EQ(connection("camera", "face"),
             "4:42: face has a count, so no drone is called just face; write \"face-*\" for all of them\n");
    CHECK_EQ(connection("camera", "view-*"), "4:42: no drone of this file fits \"view-*\"\n");
    CHECK_EQ(connection("camera", "camera"), "4:42: camera cannot be connected to itself\n");
    CHECK_EQ(connection("camera", "face-1.a b"),
             "4:42: \"a b\" is not the name of a port; write DRONE or DRONE.PORT\n");
}

TEST_CASE("swarm file: a drone that has the name of another one is the only mistake")
{
    const auto clash = with("\"a-2\": {\"kind\": \"camera\"},\n\"a\": {\"kind\": \"face\", \"count\": 3}",
                            "\"connections\": [{\"from\": \"a-2\", \"to\": \"a-3\"}]");
    CHECK_EQ(mistakes(clash, known), "3:1: two drones are called a-2; the other one comes from drones.a-2\n");
}

TEST_CASE("swarm file: a swarm and its lock have a name, too")
{
    const auto named = [](const std::string& swarm, const std::string& drone) {
        return mistakes(R"({"swarm": ")" + swarm + R"(", "drones": {")" + drone + R"(": {"kind": "k"}}})");
    };
    CHECK_EQ(named(std::string(58, 'a'), "a"), "");
    CHECK_NE(named(std::string(59, 'a'), "a"), "");
    CHECK_EQ(named("s", "s.swarm"),
             "1:27: \"s.swarm\" is what the swarm itself is locked by; call the drone something else\n");
}

TEST_CASE("swarm file: more drones of one machine than there are ports")
{
    const std::string more = "\"a\": {\"kind\": \"k\", \"count\": 1000, \"on\": \"m\"},\n"
                             "\"b\": {\"kind\": \"k\", \"count\": 1000, \"on\": \"m\"},\n"
                             "\"c\": {\"kind\": \"k\", \"on\": \"m\"}";
    CHECK_EQ(mistakes(with(more)), "4:1: more than 2000 drones of m need a free port; name ports for some: \"listen\": "
                                   "\"tcp://0.0.0.0:PORT\"\n");
    CHECK_EQ(mistakes(with(more, "\"engines\": {\"m\": {\"local\": {}}}")), "");
}

TEST_CASE("swarm file: thousands of misspelt names are all told, and soon")
{
    std::string drones, receivers;
    for (int i = 0; i < 4000; ++i) {
        drones += (i == 0 ? "" : ", ") + ("\"drone-" + std::to_string(i)) + "\": {\"kind\": \"k\"}";
        receivers += (i == 0 ? "" : ", ") + ("\"drnoe-" + std::to_string(i)) + "\"";
    }
    const auto text = with(drones, "\"connections\": [{\"from\": \"drone-1\", \"to\": [" + receivers + "]}]");
    const auto begin = std::chrono::steady_clock::now();
    CHECK_EQ(read_swarm(text).mistakes.size(), 4000u);
    CHECK(std::chrono::steady_clock::now() - begin < std::chrono::seconds(5));  // 15 when each is compared with all
}

TEST_CASE("swarm file: what a drone that cannot be read was called is not missed as well")
{
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\"}, \"b\": {\"kind\": \"k\", \"count\": 0}",
                           "\"connections\": [{\"from\": \"a\", \"to\": \"b-1\"}]")),
             "2:49: \"count\" must be a whole number from 1 to 1000, not 0\n");
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\"}, \"b\": {\"kind\": \"k\", \"count\": 0}",
                           "\"connections\": [{\"from\": \"a\", \"to\": [\"b\", \"b-*\", \"b-1.in\", \"blue\"]}]")),
             "2:49: \"count\" must be a whole number from 1 to 1000, not 0\n"
             "4:60: there is no drone \"blue\" in this file\n");
}

TEST_CASE("swarm file: the same connection twice")
{
    CHECK_EQ(mistakes(with(two, "\"connections\": [{\"from\": \"camera\", \"to\": [\"face\", \"face\"]}]")),
             "4:51: camera is connected to face already\n");
    const auto again = with(
        two,
        "\"connections\": [{\"from\": \"camera\", \"to\": \"face\"},\n{\"from\": \"camera.image\", \"to\": \"face\"}]");
    CHECK_EQ(mistakes(again), "");
    CHECK_EQ(mistakes(again, known), "5:32: camera.image is connected to face.image already\n");
}

TEST_CASE("swarm file: options that do not go together")
{
    const auto options = [](const std::string& text) {
        return mistakes(with(two, "\"connections\": [{\"from\": \"camera\", \"to\": \"face\", " + text + "}]"));
    };
    CHECK_EQ(options("\"stream\": true, \"window\": 2"), "4:66: \"window\" conflicts with \"stream\"\n");
    CHECK_EQ(options("\"stream\": false, \"window\": 2"), "");
    CHECK_EQ(options("\"lease\": 2"), "4:50: \"lease\" is for shared work; add \"share\": true, or a \"group\"\n");
    CHECK_EQ(options("\"lease\": 0, \"share\": true"),
             "4:59: \"lease\" must be a number of seconds from 0.05 to 86400, not 0\n");
}

TEST_CASE("swarm file: two drones of one machine at one port")
{
    CHECK_EQ(
        mistakes(with(
            "\"a\": {\"kind\": \"k\", \"count\": 3, \"on\": [\"m1\", \"m2\"], \"listen\": \"tcp://0.0.0.0:7700\"}")),
        "2:62: a-3 and a-1 both listen at port 7700 of m1; omit the port: each then takes a free one from 7700 up\n");
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\", \"count\": 3, \"listen\": \"tcp://0.0.0.0\"}")), "");
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\", \"listen\": \"tcp://10.0.0.1:7700\"}, \"b\": {\"kind\": \"k\", "
                           "\"listen\": \"tcp://10.0.0.2:7700\"}")),
             "");
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\", \"listen\": \"tcp://10.0.0.1:7700\"},\n\"b\": {\"kind\": \"k\", "
                           "\"listen\": \"tcp://[::]:7700\"}")),
             "3:30: b and a both listen at port 7700 of this machine; omit the port: each then takes a free one from "
             "7700 up\n");
}

TEST_CASE("swarm file: where a drone is found, when nobody could find it there")
{
    const auto drone = [](const std::string& keys) { return mistakes(with("\"a\": {\"kind\": \"k\", " + keys + "}")); };
    CHECK_EQ(drone("\"advertise\": \"tcp://cam1\""),
             "2:20: \"advertise\" needs a port to advertise; add \"listen\": \"tcp://0.0.0.0\"\n");
    CHECK_EQ(drone("\"advertise\": \"tcp://cam1\", \"on\": \"cam1\""), "");  // there it listens without being told
    CHECK_EQ(drone("\"listen\": \"tcp://h\", \"advertise\": \"tcp://0.0.0.0\""),
             "2:54: \"tcp://0.0.0.0\": cannot be dialed; write tcp://HOST or tcp://HOST:PORT, with a host name or "
             "address that other machines can reach\n");
    CHECK_EQ(drone("\"listen\": \"unix:/x\""),
             "2:30: \"unix:/x\" is not a network address; write tcp://HOST or tcp://HOST:PORT\n");
    CHECK_EQ(drone("\"listen\": \"tcp://h:99999\""), "2:30: invalid address \"tcp://h:99999\": the port is not a "
                                                     "number from 0 to 65535; write tcp://HOST or tcp://HOST:PORT\n");
}

TEST_CASE("swarm file: an engine behind one that fits the same machines")
{
    const auto engines = [](const std::string& globs) {
        return mistakes(with("\"a\": {\"kind\": \"k\", \"on\": \"n1\"}, \"b\": {\"kind\": \"k\", \"on\": \"m1\"}",
                             "\"engines\": {" + globs + "}"),
                        any);
    };
    CHECK_EQ(engines("\"n*\": {\"slurm\": {}}, \"*\": {\"local\": {}}"), "");
    CHECK_EQ(engines("\"*\": {\"local\": {}}, \"n*\": {\"slurm\": {}}"),
             "4:33: \"n*\" counts for no drone: an engine before it fits the same machines; write the narrower one "
             "first\n");
}

TEST_CASE("swarm file: what systemd would always start again")
{
    const auto restart = [](const std::string& word) {
        return mistakes(with("\"a\": {\"kind\": \"k\", \"restart\": \"" + word + "\"}",
                             "\"engines\": {\"local\": {\"systemd\": {}}}"),
                        any);
    };
    CHECK_EQ(restart("on-failure"), "");
    CHECK_EQ(restart("always"), "2:31: a: hivectl stop and down cannot stop a unit that systemd always restarts; write "
                                "\"restart\": \"on-failure\"\n");
}

TEST_CASE("swarm file: systemd starts no drone of another machine")
{
    const auto on = [](const std::string& hosts) {
        return mistakes(with("\"a\": {\"kind\": \"k\", \"count\": 2, \"on\": " + hosts + "}",
                             "\"engines\": {\"*\": {\"systemd\": {}}}"),
                        any);
    };
    CHECK_EQ(on("\"local\""), "");
    CHECK_EQ(
        on("[\"local\", \"cam1\"]"),
        "2:38: systemd starts drones of this machine, and not of cam1; leave that engine out; to have units written "
        "for each machine: hivectl export --as systemd\n");
}

TEST_CASE("swarm file: an encoding that the output does not have, or the receiver does not take")
{
    const auto encoding = [](const std::string& from, const std::string& to, const std::string& word) {
        return mistakes(with("\"camera\": {\"kind\": \"camera\"}, \"face\": {\"kind\": \"face\"}, "
                             "\"only-boxes\": {\"kind\": \"boxes\"}",
                             "\"connections\": [{\"to\": \"" + to + "\", \"from\": \"" + from + "\", \"encoding\": \""
                                 + word + "\"}]"),
                        [](const std::string& kind) {
                            auto interface = known(kind == "boxes" ? "face" : kind);
                            if (kind == "boxes")
                                interface.inputs = {{"boxes", "application/json", ""}, {"image", "image/jpeg", ""}};
                            return interface;
                        });
    };
    for (const char* good : {"jpeg", "jpeg:100", "png", "raw"})
        CHECK_EQ(encoding("camera", "face", good), "");
    CHECK_EQ(encoding("camera", "face", "jpeg:200"),
             "4:24: there is no encoding \"jpeg:200\"; there are jpeg, jpeg:1 to jpeg:100, png, raw\n");
    CHECK_EQ(encoding("camera", "only-boxes.image", "png"),
             "4:24: output image as png is image/png, but only-boxes takes image/jpeg\n");
    CHECK_EQ(encoding("face.faces", "only-boxes", "png"),
             "4:24: output faces has no encodings; its events are sent as is\n");
}

TEST_CASE("swarm file: a missing key file is found where a drone names it or needs it")
{
    setenv("HIVE_KEY", "/nowhere/swarm.key", 1);
    const std::string get = "make one: hivectl key new; or copy the swarm's from a machine that has it: scp "
                            "HOST:.config/hive/swarm.key ";
    const auto drone = [](const std::string& more) {
        return mistakes(with("\"a\": {\"kind\": \"camera\"" + more + "}"), known, {.to_be_started = true});
    };
    CHECK_EQ(drone(""), "");
    CHECK_EQ(drone(", \"key\": \"/nowhere/else\""),
             "2:32: there is no swarm key at /nowhere/else; " + get + "/nowhere/else\n");
    CHECK_EQ(drone(", \"listen\": \"tcp://0.0.0.0\""),
             "2:35: anyone could control the drone through this port, and there is no swarm key at /nowhere/swarm.key; "
                 + get + "/nowhere/swarm.key; or, on a network that you trust wholly, add \"insecure\": true\n");
    CHECK_EQ(drone(", \"listen\": \"tcp://0.0.0.0\", \"insecure\": true"), "");
    for (const std::string more : {"", ", \"listen\": \"tcp://0.0.0.0\""}) {
        CHECK_EQ(drone(more + ", \"on\": \"m1\""),
                 "2:" + std::to_string(31 + more.size())
                     + ": drones of other machines require the swarm's key, and there is no swarm key at "
                       "/nowhere/swarm.key; "
                     + get + "/nowhere/swarm.key\n");
        CHECK_EQ(drone(more + ", \"on\": \"m1\", \"insecure\": true"), "");
    }
    const auto by_glob = mistakes(with("\"a\": {\"kind\": \"camera\"}", "\"engines\": {\"*\": {\"slurm\": {}}}"), known,
                                  {.to_be_started = true});
    CHECK(by_glob.starts_with("2:"));
    unsetenv("HIVE_KEY");
}

TEST_CASE("swarm file: an address to listen at that this machine does not have")
{
    const auto drone = [](const std::string& listen, const std::string& more = "") {
        return mistakes(
            with("\"a\": {\"kind\": \"camera\", \"listen\": \"tcp://" + listen + "\", \"insecure\": true" + more + "}"),
            known, {.to_be_started = true});
    };
    CHECK_EQ(drone("192.0.2.1:7700"),
             "2:35: \"tcp://192.0.2.1:7700\": this machine does not have this address; for all "
             "of its addresses: \"listen\": \"tcp://0.0.0.0\"\n");
    for (const std::string own : {"127.0.0.1", "0.0.0.0", "0.0.0.0:7700", "a-name-that-may-be-ours"})
        CHECK_EQ(drone(own), "");
    CHECK_EQ(drone("192.0.2.1", ", \"on\": \"m1\""), "");
}

TEST_CASE("swarm file: engines for machines that no drone is on")
{
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\", \"on\": \"cam1\"}", "\"engines\": {\"cma1\": {\"ssh\": \"x\"}}")),
             "4:13: no drone in this file is on a host matching \"cma1\"; did you mean cam1?\n");
    CHECK_EQ(mistakes(with("\"a\": {\"kind\": \"k\"}", "\"engines\": {\"local\": {\"ssh\": \"x\", \"local\": {}}}")),
             "4:22: an engine is exactly one of local, ssh, systemd or slurm\n");
}

TEST_CASE("swarm file: a machine is no folder, and a directive of Slurm is one line")
{
    for (const char* host : {"..", ".", "me@..", "../x"})
        CHECK_FALSE(mistakes(with("\"a\": {\"kind\": \"k\", \"on\": \"" + std::string(host) + "\"}")).empty());
    const auto file_with = [](const std::string& settings) {
        return with("\"a\": {\"kind\": \"k\", \"on\": \"n1\"}", "\"engines\": {\"n1\": {\"slurm\": " + settings + "}}");
    };
    const auto slurm = [&](const std::string& settings) { return mistakes(file_with(settings), any); };
    CHECK_EQ(slurm(R"({"partition": "gpu", "options": ["--gres=gpu:1"]})"), "");
    CHECK(slurm(R"({"partition": "p\ntouch x"})").find("does not belong into a line") != std::string::npos);
    for (const char* key : {"options", "job"})
        CHECK(slurm(R"({")" + std::string(key) + R"(": ["--a\nid"]})").find("does not belong into a line")
              != std::string::npos);
    CHECK_EQ(slurm(R"({"job": ["--time=60", "--requeue"]})"), "");
    CHECK_EQ(slurm(R"({"options": ["gres=gpu:1"]})"),
             "4:42: \"gres=gpu:1\" is not a Slurm option; options start with -, such as --gres=gpu:1\n");
    CHECK_EQ(mistakes(file_with(R"({"options": ["gres=gpu:1"]})")), "");  // a remembered plan can be taken down
}

TEST_CASE("swarm file: with interfaces, parameters are checked")
{
    const auto settings = [](const std::string& text) {
        return mistakes(with("\"camera\": {\"kind\": \"camera\", \"set\": {" + text + "}}"), known);
    };
    CHECK_EQ(settings("\"fps\": 30, \"source\": \"/dev/video0\""), "");
    CHECK_EQ(settings("\"fps\": \"30\""), "");
    CHECK_EQ(settings("\"fsp\": 30"), "2:38: a drone of the kind camera has no parameter \"fsp\"; did you mean fps?\n");
    CHECK_EQ(settings("\"fps\": 3000"), "2:45: fps=3000: must be a number, 0 to 1000\n");
    CHECK_EQ(settings("\"source\": 3"), "2:48: source=3: must be a text\n");
}

TEST_CASE("swarm file: with interfaces, ports and their types are checked")
{
    const auto connection = [](const std::string& text) {
        return mistakes(with(two
                                 + ", \"track\": {\"kind\": \"track\", \"count\": 2}, \"other\": {\"kind\": "
                                   "\"elsewhere\", \"on\": \"m1\"}",
                             "\"connections\": [{" + text + "}]"),
                        known);
    };
    CHECK_EQ(connection("\"from\": \"camera\", \"to\": \"face\""), "");
    CHECK_EQ(connection("\"from\": \"other\", \"to\": \"face\""), "");  // nobody here knows its ports
    CHECK_EQ(connection("\"from\": \"camera.imag\", \"to\": \"other\""),
             "4:47: camera has no output imag; did you mean image?\n");
    CHECK_EQ(connection("\"from\": \"face.faces\", \"to\": \"track-1.image\""),
             "4:46: face.faces is application/json, but track-1.image takes image/jpeg,image/png,image/raw\n");
    CHECK_EQ(connection("\"from\": \"camera\", \"to\": \"track-*\", \"share\": true"),
             "4:42: track-1 keeps state between events, so it must see every one: it cannot share\n");
}

TEST_CASE("swarm file: each kind is asked for once")
{
    int asked = 0;
    const auto reading =
        read_swarm(with("\"a\": {\"kind\": \"camera\", \"count\": 50}, \"b\": {\"kind\": \"face\", \"count\": 50}",
                        "\"connections\": [{\"from\": \"a-*\", \"to\": \"b-*\"}]"),
                   [&](const std::string& kind) {
                       ++asked;
                       return known(kind);
                   });
    CHECK(reading.mistakes.empty());
    REQUIRE_EQ(reading.plan.connections.size(), 2500u);
    CHECK(reading.plan.connections[2499] == SwarmConnection{{"a-50", "image"}, {"b-50", "image"}, {}});
    CHECK_EQ(asked, 2);
}

TEST_CASE("swarm file: a kind that is not here is a mistake where its drone is, and a note for another machine")
{
    const auto file = [](const std::string& engines) {
        return with("\"a\": {\"kind\": \"nosuch\", \"on\": \"m1\", \"set\": {\"x\": 1}},\n\"b\": {\"kind\": "
                    "\"nosuch\", \"on\": \"m2\"}",
                    "\"engines\": {" + engines + "}");
    };
    const auto elsewhere = read_swarm(file("\"m1\": {\"slurm\": {}}"), known);
    CHECK(elsewhere.mistakes.empty());
    REQUIRE_EQ(elsewhere.notes.size(), 1u);
    CHECK_EQ(elsewhere.notes[0].line, 2u);
    CHECK_EQ(elsewhere.notes[0].at, "drones.a.kind");
    CHECK_EQ(mistakes(file("\"m2\": {\"local\": {}}"), known), "3:15: there is no drone hive-nosuch; build it\n");
    CHECK_EQ(mistakes(with("\"c\": {\"kind\": \"nosuch\"}"), known), "2:15: there is no drone hive-nosuch; build it\n");
    CHECK_EQ(mistakes(with("\"c\": {\"kind\": \"nosuch\"}")), "");
}
