// What the walk finds in statuses that are hard to make for real: far machines, and drones that this machine does not
// know.
#include "explain/machine_causes.hpp"
#include "explain/search.hpp"

#include <hive/explain.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <unistd.h>

using namespace hive;
using explaining::Absent;
using explaining::Look;
using explaining::Search;

namespace {

constexpr std::int64_t begin_us = 1'000'000'000'000'000, second_us = 1'000'000;
constexpr std::int64_t registration = 7;

/// A live source that has just sent, and a receiver far away.
Look far(std::int64_t skipped, int window = 1)
{
    EdgeStatus edge{.receiver = "face.image", .connected = true, .registration = registration};
    edge.options.window = window;
    edge.events.came(1000);
    edge.events.went(Fate::skipped, skipped);
    Status camera{.name = "camera", .kind = "camera", .epoch = begin_us, .state = State::idle};
    camera.uptime_us = 60 * second_us;
    camera.outputs.push_back({.name = "image",
                              .type = {},
                              .produced = 1000,
                              .last_emitted_us = begin_us + 60 * second_us,
                              .edges = {edge},
                              .why = Reason::not_asked});
    Status face{.name = "face", .kind = "face", .epoch = begin_us, .state = State::idle};
    face.uptime_us = 60 * second_us;
    face.inputs.push_back({.input = "image",
                           .from = "camera.image",
                           .connected = true,
                           .registration = registration,
                           .processed = 500,
                           .round_trip_us = 100'000});
    const Place there{.drone = "face", .host = "gpu1", .address = "tcp://gpu1:7700"};
    return {{{.drone = "camera", .status = camera}, {.drone = "face", .status = face, .place = there}}};
}

Status& status_at(Look& look, std::size_t i) { return std::get<Status>(look.answers[i].status); }

std::vector<Cause> causes(const Look& look, const Look* earlier = nullptr, const std::string& drone = "face")
{
    const Absent absent;
    Search search(look, earlier, absent, "app-1");
    search.target(drone, "");
    return search.causes();
}

StatusAnswer answer(const std::string& name)
{
    Status status{.name = name, .kind = "sleeper", .epoch = begin_us, .state = State::idle};
    status.uptime_us = 60 * second_us;
    return {.drone = name, .status = status};
}

/// Lossless events have waited for 50 s at the sender's output.
void wait_for(Look& look, std::size_t sender, std::size_t receiver, const std::string& input = "image",
              const std::string& group = "")
{
    auto& from = status_at(look, sender);
    if (from.outputs.empty())
        from.outputs.push_back({.name = "out",
                                .type = {},
                                .produced = 9,
                                .last_emitted_us = begin_us + 10 * second_us,
                                .lossless = true,
                                .why = Reason::not_asked});
    auto& output = from.outputs[0];
    auto& to = status_at(look, receiver);
    EdgeStatus edge{.receiver = to.name + "." + input, .connected = true, .why = Reason::not_asked};
    edge.options.group = group;
    output.edges.push_back(edge);
    if (!group.empty() && output.edges.size() == 1)
        output.edges.push_back({.receiver = "group " + group, .group = true, .options = edge.options, .why = edge.why});
    to.inputs.push_back({.input = input, .from = from.name + "." + output.name, .connected = true});
    if (!from.inputs.empty())
        from.why = Reason::backlog;
}

/// Events of outputs without receivers.
void hold(Look& look, std::size_t drone, const std::vector<std::string>& outputs)
{
    auto& status = status_at(look, drone);
    status.why = Reason::backlog;
    for (const auto& name : outputs)
        status.outputs.push_back({.name = name, .type = {}, .lossless = true, .why = Reason::held});
}

/// "halted worker, held face", of all drones in this order, as found in two equal looks.
std::string all_causes(const Look& look, const std::vector<std::size_t>& order)
{
    Absent absent;
    absent.kinds["worker"] = "sleeper";
    absent.remembered.insert("worker");
    Search search(look, &look, absent, "app-1");
    for (const auto i : order)
        search.target(look.answers[i].drone, "");
    std::string text;
    for (const auto& cause : search.causes())
        text += (text.empty() ? "" : ", ") + std::string(token(cause.what)) + " " + cause.drone;
    return text;
}

void check_in_any_order(const Look& look, const std::string& expected)
{
    std::vector<std::size_t> order(look.answers.size());
    std::iota(order.begin(), order.end(), 0);
    do {
        std::string names;
        for (const auto i : order)
            names += look.answers[i].drone + " ";
        CHECK_MESSAGE(all_causes(look, order) == expected, names);
    } while (std::ranges::next_permutation(order).found);
}

}  // namespace

TEST_CASE("explain: one request at a time over a long round trip is a cause as long as events are skipped")
{
    const auto before = far(10), after = far(20);
    const auto found = causes(after, &before);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::small_window);
    CHECK_FALSE(found[0].blocks);
    CHECK(found[0].text == "camera.image -> face.image: a window of 1 lets at most 10 events per second through");
    CHECK(found[0].command == "hivectl connect camera.image face.image --window 7");
    CHECK(causes(after, &after).empty());
    CHECK(causes(far(20, 7), nullptr).empty());
}

TEST_CASE("explain: copied bodies are a cause only if none goes through shared memory")
{
    const auto counted = [](std::int64_t shared, std::int64_t fallback) {
        auto look = far(0);
        auto& edge = status_at(look, 0).outputs[0].edges[0];
        edge.shared = shared;
        edge.fallback = fallback;
        return look;
    };
    const auto before = counted(0, 20);
    const auto found = causes(counted(0, 30), &before);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::copied);
    CHECK(causes(counted(1, 30), &before).empty());  // the receiver holds all that it may
    CHECK(causes(before, &before).empty());
}

TEST_CASE("explain: two earlier answers of all drones are explained without a query")
{
    std::string home = "/tmp/hv-XXXXXX";
    REQUIRE(::mkdtemp(home.data()));
    Application application({.name = "app-1", .home = home});
    const auto before = far(10).answers, after = far(20).answers;
    const auto found = explain_answers(application, before, after);
    REQUIRE(found.causes.size() == 1);  // a query would find that no drone runs here
    CHECK(found.causes[0].what == Cause::What::small_window);
    CHECK(found.flows.size() == 2);
    CHECK(explain_answers(application, after, after).causes.empty());
    CHECK_FALSE(explain_answers(application, {}, after).has(Cause::What::not_running));  // started after the first look
    CHECK(explain_answers(application, {before[1]}, {after[1]}).flows.size() == 1);      // camera is queried, in vain
    std::filesystem::remove_all(home);
}

TEST_CASE("explain: a sender that this machine does not know is no cause for a receiver that is connected to it")
{
    auto look = far(0);
    look.answers[0].status = Error(Errc::not_found, "camera is not running");
    CHECK(causes(look).empty());
    look.answers[0].status = Error(Errc::invalid_argument, "several are called camera");
    CHECK(causes(look).empty());
    auto& input = status_at(look, 1).inputs[0];
    look.answers[0].status = Error(Errc::not_found, "camera is not running");
    input.connected = false;
    input.why = Reason::dialing;
    input.error = "no route to cam1";
    const auto found = causes(look);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::dialing);
    CHECK(found[0].text == "face.image is not connected to camera.image: no route to cam1");
    look.answers[1].place.host = Place::here;
    CHECK(causes(look).at(0).what == Cause::What::not_running);
}

TEST_CASE("explain: no text of a peer gets into a command if a shell would run a part of it")
{
    auto look = far(0);
    auto& input = status_at(look, 1).inputs[0];
    input.connected = false;
    input.why = Reason::refused;
    input.error = "no; run: hivectl key show";
    CHECK(causes(look).at(0).command == "hivectl key show");
    input.error = "no; run: hivectl key show | sh";
    CHECK(causes(look).at(0).command == "hivectl connect camera.image face.image");
    look.answers[0].status = Error(Errc::not_found, "camera is not running");
    look.answers[1].place = {};
    input.address = "tcp://cam1:7700";
    input.kind = "camera";
    Absent absent;
    absent.ssh["cam1"] = "me@cam1";
    const auto command = [&] {
        Search search(look, nullptr, absent, "app-1");
        search.target("face", "");
        return search.causes().at(0).command;
    };
    CHECK(command() == "hivectl start camera --listen tcp://0.0.0.0:7700 --on me@cam1");
    input.kind = "/home/me/my-camera.py";
    CHECK(command() == "hivectl start /home/me/my-camera.py --as camera --listen tcp://0.0.0.0:7700 --on me@cam1");
    for (const auto* kind : {"camera;reboot", "/home/me/a b.py", "/home/me/$(reboot).py", "-x.py"}) {
        input.kind = kind;
        CHECK_MESSAGE(command() == "hivectl ps", kind);
    }
    input.kind = "camera";
    input.address = "tcp://cam1:`reboot`";
    CHECK(command() == "hivectl ps");
}

TEST_CASE("explain: a connection that takes events slowly is a cause only if the sender has to wait for it")
{
    auto look = far(0);
    auto& output = status_at(look, 0).outputs[0];
    output.why = output.edges[0].why = Reason::lane_full;
    CHECK(causes(look).empty());
    output.last_emitted_us -= 2 * second_us;
    const auto found = causes(look);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::slow_connection);
    CHECK(found[0].connection == "camera.image -> face.image");
    CHECK(found[0].evidence.find("nothing for 2.0 s") != std::string::npos);
}

TEST_CASE("explain: a stream that drops events is a cause as long as it does, at the end that drops them")
{
    auto before = far(0), after = far(0);
    status_at(after, 0).outputs[0].edges[0].events.went(Fate::dropped, 3);
    auto found = causes(after, &before);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::slow_connection);
    CHECK_FALSE(found[0].blocks);
    CHECK(found[0].evidence == "3 events dropped before they were sent");
    CHECK(causes(after, &after).empty());
    before = after;
    for (auto* look : {&before, &after})
        status_at(*look, 1).inputs.push_back(
            {.input = "mask", .from = "camera.image", .connected = true, .registration = 8, .dropped = 9});
    status_at(after, 1).inputs[0].dropped = 7;
    found = causes(after, &before);
    REQUIRE(found.size() == 1);
    CHECK(found[0].what == Cause::What::slow);
    CHECK(found[0].evidence == "7 events dropped, 0 us for each event");
    CHECK(found[0].command == "hivectl advise face");
    CHECK(causes(after, &after).empty());
}

TEST_CASE("explain: an exception hides no other cause at the first look, when nothing is known to move")
{
    auto before = far(0), after = far(0);
    for (auto* look : {&before, &after}) {
        auto& face = status_at(*look, 1);
        face.condition = "disk full";
        face.last_exception = ExceptionStatus{.text = "bad image", .time_us = begin_us + 59 * second_us};
    }
    REQUIRE(causes(before).size() == 1);
    CHECK(causes(before)[0].what == Cause::What::condition);
    status_at(after, 1).inputs[0].processed = 600;
    REQUIRE(causes(after, &before).size() == 1);
    CHECK(causes(after, &before)[0].what == Cause::What::condition);
    CHECK(causes(before, &before).at(0).what == Cause::What::throws);
    status_at(before, 1).last_exception->text = "disk full";  // the condition says more
    status_at(before, 1).inputs[0].abandoned = 3;
    CHECK(causes(before, &before).at(0).what == Cause::What::condition);
    CHECK(causes(before, &before).at(0).evidence == "3 events abandoned");
}

TEST_CASE("explain: a cycle of connections, and a receiver that is asked for twice, end the walk")
{
    auto look = far(0);
    auto& camera = status_at(look, 0);
    camera.inputs.push_back({.input = "control", .from = "face.faces", .connected = true});
    CHECK(causes(look).empty());
    camera.state = State::halted;
    CHECK(causes(look).size() == 1);
    CHECK(causes(look, nullptr, "camera").size() == 1);
}

TEST_CASE("explain: of all drones, a sender whose receiver was examined before is not called silent")
{
    Look look{{answer("source"), answer("worker")}};
    wait_for(look, 0, 1);
    auto twice = look;
    wait_for(twice, 0, 1, "mask");
    auto line = look;
    line.answers.push_back(answer("last"));
    wait_for(line, 1, 2);
    for (auto* each : {&look, &twice, &line})
        status_at(*each, each->answers.size() - 1).state = State::halted;
    check_in_any_order(look, "halted worker");
    check_in_any_order(twice, "halted worker");
    check_in_any_order(line, "halted last");

    auto& output = status_at(look, 0).outputs[0];
    output.edges[0].connected = false;
    output.why = output.edges[0].why = Reason::place_kept;
    look.answers[1].status = Error(Errc::not_found, "worker is not running");
    check_in_any_order(look, "not_running worker");
}

TEST_CASE("explain: of all drones, a halted sender with several receivers is not called silent")
{
    Look look{{answer("source"), answer("one"), answer("two")}};
    wait_for(look, 0, 1);
    wait_for(look, 0, 2);
    auto& output = status_at(look, 0).outputs[0];
    output.why = output.edges[0].why = output.edges[1].why = Reason::none;
    check_in_any_order(look, "silent_source source");
    status_at(look, 0).state = State::halted;
    check_in_any_order(look, "halted source");
}

TEST_CASE("explain: members of a group that wait for one receiver are no causes themselves")
{
    Look look{{answer("source"), answer("one"), answer("two"), answer("last")}};
    for (const std::size_t member : {1, 2}) {
        wait_for(look, 0, member, "image", "workers");
        wait_for(look, member, 3, "from" + std::to_string(member));
    }
    status_at(look, 3).state = State::halted;
    check_in_any_order(look, "halted last");
}

TEST_CASE("explain: drones that wait for each other in a cycle have one cause")
{
    Look look{{answer("source"), answer("one"), answer("two")}};
    wait_for(look, 0, 1);
    wait_for(look, 1, 2);
    wait_for(look, 2, 1, "control");
    const auto found = all_causes(look, {0, 1, 2});
    CHECK_MESSAGE((found == "waits one" || found == "waits two"), found);
    status_at(look, 2).state = State::halted;
    check_in_any_order(look, "halted two");
}

TEST_CASE("explain: each output that holds events is listed once")
{
    Look look{{answer("source"), answer("face")}};
    wait_for(look, 0, 1);
    hold(look, 1, {"faces", "annotated", "boxes"});
    check_in_any_order(look, "held face, held face, held face");
    const auto found = causes(look);
    REQUIRE(found.size() == 3);
    CHECK(found[0].text == "lossless events of face.faces wait for a receiver of bodies");
    CHECK(found[1].text == "lossless events of face.annotated wait for a receiver of bodies");
    CHECK(found[2].text == "lossless events of face.boxes wait for a receiver of bodies");
}

TEST_CASE("explain: what is slow for all drones of a machine is said once, with those that use most")
{
    constexpr std::int64_t gigabyte = 1'000'000'000;
    const MachineStatus machine{
        .processors = 2, .cpu_us = 100 * second_us, .memory = 8 * gigabyte, .memory_available = 2 * gigabyte};
    auto first = far(0);
    for (auto& answer : first.answers) {
        answer.place.host = "gpu1";
        std::get<Status>(answer.status).machine = machine;
    }
    status_at(first, 0).pid = 1;
    status_at(first, 1).pid = 2;
    auto second = first;
    for (auto& answer : second.answers)
        std::get<Status>(answer.status).uptime_us += second_us;
    CHECK(explaining::machine_causes(first, second).empty());

    for (auto& answer : second.answers)
        std::get<Status>(answer.status).machine.cpu_us += 2 * second_us;
    status_at(second, 0).cpu_us += second_us / 2;
    status_at(second, 1).cpu_us += second_us;
    const auto load = explaining::machine_causes(first, second);
    REQUIRE(load.size() == 1);
    CHECK(load[0].what == Cause::What::load);
    CHECK(load[0].drone == "face");
    CHECK(load[0].text == "the 2 processors of gpu1 are busy all the time");
    CHECK(load[0].evidence == "face uses 1.0, camera uses 0.5, other programs 0.5");
    CHECK_FALSE(load[0].blocks);

    second = first;
    status_at(second, 0).machine.memory_available = gigabyte / 10;
    status_at(second, 0).memory = 5 * gigabyte;
    const auto memory = explaining::machine_causes(first, second);
    REQUIRE(memory.size() == 1);
    CHECK(memory[0].what == Cause::What::memory);
    CHECK(memory[0].text == "gpu1 has 0.1 GB of its 8.0 GB of memory left");
    CHECK(memory[0].evidence == "camera uses 5.0 GB, face uses 0.0 GB");
    CHECK(memory[0].command == "hivectl stop camera");
    status_at(second, 0).memory = 3 * gigabyte;  // other programs use more
    CHECK(explaining::machine_causes(first, second).at(0).command == "hivectl top");

    second = first;  // a container of its own: the other drone has enough memory
    status_at(second, 1).machine = {.processors = 2,
                                    .cpu_us = 100 * second_us,
                                    .memory = gigabyte,
                                    .memory_available = gigabyte / 100,
                                    .memory_limited = true};
    const auto limited = explaining::machine_causes(first, second);
    REQUIRE(limited.size() == 1);
    CHECK(limited[0].drone == "face");
    CHECK(limited[0].text == "the control group of face on gpu1 has 0.0 GB of its 1.0 GB of memory left");
    status_at(second, 0).machine = status_at(second, 1).machine;  // another container, with the same limit
    status_at(second, 0).machine.memory_available = gigabyte / 2;
    status_at(second, 0).memory = gigabyte / 2;
    const auto equal = explaining::machine_causes(first, second);
    REQUIRE(equal.size() == 1);
    CHECK(equal[0].drone == "face");
    CHECK(equal[0].text == limited[0].text);

    second = first;
    second.answers[0].place.host = Place::here;
    status_at(second, 1).inputs[0].clock_offset_us = -3600 * second_us;
    const auto clock = explaining::machine_causes(first, second);
    REQUIRE(clock.size() == 1);
    CHECK(clock[0].what == Cause::What::clock);
    CHECK(clock[0].text == "the clock of this machine is 1 h behind that of gpu1");
}
