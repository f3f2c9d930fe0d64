// The input at which a drone failed is kept, shown, saved, and fed to a fresh drone.
#include "own_temp.hpp"
#include "swarm.hpp"

#include <hive/application.hpp>
#include <hive/rerun.hpp>

#include <csignal>
#include <doctest/doctest.h>
#include <fstream>
#include <set>
#include <sys/stat.h>

namespace {

using namespace hive;
using namespace std::chrono_literals;
using hive::test::eventually;
using hive::test::failures;
using hive::test::has;
using hive::test::OwnTemp;
using hive::test::Swarm;

void connect(Application& application, const std::string& receiver, const std::string& input = "image",
             const ConnectionOptions& options = {})
{
    application.connect({"source", "tick"}, {receiver, input}, options);
}

/// The first one with at least this number. For a stream the exact event of the crash is unknown.
const hive::Event& input_from(const hive::KeptFailure& failure, std::int64_t sequence)
{
    for (const auto& event : failure.inputs)
        if (event.identity.sequence >= sequence)
            return event;
    throw std::runtime_error("no input from " + std::to_string(sequence) + " on was kept");
}

}  // namespace

TEST_CASE("failures: a drone that dies of one certain event is reproduced from the kept input in one command")
{
    for (const auto& [pace, how] : {std::pair{"live", "sync"}, {"live", "stream"}, {"demand", "sync"}}) {
        CAPTURE(pace);
        CAPTURE(how);
        const Swarm swarm;
        auto application = swarm.application();
        auto victim = swarm.drone("breaker", "victim", {"how=null", std::string(pace) == "demand" ? "at=7" : "from=7"});
        const auto results = application.collect({{"victim", "seen"}});
        ConnectionOptions options;
        options.transfer = std::string(how) == "stream" ? Transfer::streaming : Transfer::synchronized;
        const auto source = swarm.drone("ticker", "source", {"fps=30", "bytes=100", std::string("pace=") + pace},
                                        {"--expect", "victim.image"});
        connect(application, "victim", "image", options);
        REQUIRE(victim.wait(test::patient(20s)));
        const auto kept = failures(application, "victim");
        REQUIRE(kept.size() == 1);
        CHECK(kept[0].code == "died");
        CHECK(has(kept[0].text, "SIGSEGV in breaker::write_to_null("));
        CHECK((kept[0].inputs.size() == 1 || std::string(how) == "stream"));
        const auto& input = input_from(kept[0], 7);
        CHECK((std::string(pace) == "live" || input.identity.sequence == 7));
        CHECK(input.identity.source == "source");
        CHECK(input.body.size() == 100);
        CHECK(input.header.at("index") == input.identity.sequence);

        const auto shown = swarm.hivectl_done({"exceptions", "victim"});
        CHECK(has(shown, "SIGSEGV in breaker::write_to_null("));
        const OwnTemp temp(swarm);
        const auto again = swarm.hivectl({"rerun", "victim"}, 30s);
        CAPTURE(again.err);
        CHECK(again.exit_code == 9);
        CHECK(again.out.starts_with("victim died: SIGSEGV in breaker::write_to_null("));
        CHECK(has(again.out, "(breaker.cpp:"));
        CHECK(has(again.err, "crashed: SIGSEGV"));
        CHECK(temp.empty());
        CHECK(std::ranges::count(application.drones(), "victim") == 0);  // the fresh one did not join
        CHECK(application.failures("victim").size() == 1);
        const auto passed = swarm.hivectl({"rerun", "victim", "1", "how=none"}, 30s);
        CHECK_MESSAGE(passed.exit_code == 0, passed.err);
        CHECK_MESSAGE(passed.out.starts_with("victim did not fail: emitted "), passed.out);
    }
}

TEST_CASE("failures: what a drone's code threw at is kept by the drone, at most 4, for its user alone")
{
    const Swarm swarm;
    auto application = swarm.application();
    const auto victim = swarm.drone("breaker", "victim", {"how=throw", "from=1"});
    const auto source = swarm.drone("ticker", "source", {"fps=20", "bytes=100", "count=5"});
    const auto exceptions = application.exceptions({"victim"});
    connect(application, "victim", "image", {.transfer = Transfer::streaming});
    std::vector<std::int64_t> thrown;
    while (const auto event = exceptions->next(thrown.empty() ? test::patient(10'000ms) : test::patient(1000ms)))
        thrown.push_back(event->identity.sequence);
    REQUIRE(thrown.size() >= 2);
    const auto kept = application.failures("victim");
    CHECK(kept.size() == std::min<std::size_t>(thrown.size(), 4));
    CHECK(kept.back().number == static_cast<std::int64_t>(thrown.size()));
    CHECK(kept.back().inputs.at(0).identity.sequence == thrown.back());
    for (const auto& entry : std::filesystem::directory_iterator(swarm.home() / ".failures")) {
        struct stat info {};
        REQUIRE(::stat(entry.path().c_str(), &info) == 0);
        CHECK((info.st_mode & 0777) == 0600);
    }
    const auto rows = Json::parse(swarm.hivectl_done({"exceptions", "victim", "--json"}));
    CHECK(rows.size() == kept.size());
    CHECK(rows.back().at("number") == kept.back().number);
    CHECK(rows.back().at("kept") == 100);
    CHECK(rows.back().at("policy") == "skip");
    const auto again = swarm.hivectl({"rerun", "victim", "--json"}, 30s);
    CHECK(again.exit_code == 9);
    const auto row = Json::parse(again.out);
    CHECK(row.at("outcome") == "threw");
    CHECK(row.at("rerun_text") == "broken, as told");
    CHECK(row.at("seq") == thrown.back());
    CHECK(swarm.hivectl({"rerun", "victim", "99"}).exit_code == 3);
}

TEST_CASE("failures: they are saved as files that others open, and none is written over")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto victim = swarm.drone("breaker", "victim", {"how=null", "from=1"});
    std::string body("\xff\xd8 as good as an image");
    application.put({"victim", "image"}, Json{{"page", 3}}, Body(body), "image/jpeg");
    static_cast<void>(victim.wait(test::patient(20s)));
    CHECK(swarm.hivectl({"exceptions", "--save", (swarm.home() / "out").string()}).exit_code == 3);  // `put` keeps none

    auto thrower = swarm.drone("breaker", "thrower", {"how=throw", "from=1"});
    application.put({"thrower", "image"}, Json{{"page", 3}}, Body(body), "image/jpeg");
    failures(application, "thrower");
    const auto out = swarm.home() / "out";
    CHECK(swarm.hivectl_done({"exceptions", "thrower", "--save", out.string()})
          == (out / "thrower-1.image.jpg").string() + "\n" + (out / "thrower-1.image.json").string() + "\n"
                 + (out / "thrower-1.failure").string() + "\n");
    std::ifstream image(out / "thrower-1.image.jpg", std::ios::binary);
    CHECK(std::string(std::istreambuf_iterator<char>(image), {}) == body);
    std::ifstream about(out / "thrower-1.image.json");
    const auto json = Json::parse(about);
    CHECK(json.at("text") == "broken, as told");
    CHECK(json.at("event").at("header").at("page") == 3);
    CHECK(json.at("body") == "thrower-1.image.jpg");
    const auto again = swarm.hivectl({"exceptions", "thrower", "--save", out.string()});
    CHECK(again.exit_code == 5);
    CHECK(has(again.err, "thrower-1.image.jpg already exists"));
}

TEST_CASE("failures: of a drone that hangs and is killed its sender keeps what it had in hand")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto victim = swarm.drone("breaker", "victim", {"how=hang", "from=5"});
    const auto source = swarm.drone("ticker", "source", {"fps=30"});
    connect(application, "victim", "image", {.transfer = Transfer::streaming});
    REQUIRE(eventually([&] { return application.status("victim").busy_for_us > 300'000; }));
    CHECK(application.failures("victim").empty());
    ::kill(victim.pid(), SIGKILL);
    const auto kept = failures(application, "victim");
    input_from(kept.at(0), 5);
    CHECK(kept.at(0).text == "its process ended");
    const auto again = swarm.hivectl({"rerun", "victim", "--timeout", "2"}, 30s);
    CHECK_MESSAGE(again.exit_code == 9, again.err);
    CHECK(again.out == "victim had not finished after 2.0 s and was killed\n");
}

TEST_CASE("failures: one that is suspended and cut off, and one that holds work for longer than its lease")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto silent = swarm.drone("breaker", "silent", {"how=hang", "from=5"});
    auto late = swarm.drone("breaker", "late", {"how=hang", "from=1"});
    const auto source = swarm.drone("ticker", "source", {"fps=30"});
    connect(application, "silent", "image", {.transfer = Transfer::streaming});
    ConnectionOptions member;
    member.group = "workers";
    member.lease = 200ms;
    connect(application, "late", "image", member);
    REQUIRE(eventually([&] { return application.status("silent").busy_for_us > 100'000; }));
    const auto held = failures(application, "late");
    CHECK(held.at(0).code == "late");
    ::kill(silent.pid(), SIGSTOP);
    const auto kept = failures(application, "silent");
    ::kill(silent.pid(), SIGKILL);
    CHECK(kept.at(0).code == "silent");
    input_from(kept.at(0), 5);
    ::kill(late.pid(), SIGKILL);  // the same run: the same failure, reported again
    REQUIRE(eventually([&] { return application.failures("late").at(0).code == "died"; }));
    CHECK(application.failures("late").size() == 1);
    CHECK(application.failures("late").at(0).inputs.at(0).identity.sequence
          == held.at(0).inputs.at(0).identity.sequence);
}

TEST_CASE("failures: each of two receivers has its own, one that is replaced or stopped has none, and they outlive the "
          "sender")
{
    const Swarm swarm;
    auto application = swarm.application();
    auto one = swarm.drone("breaker", "one", {"how=exit", "from=5"});
    auto two = swarm.drone("breaker", "two", {"how=null", "from=9"});
    swarm.hivectl_done({"start", "breaker", "--as", "well", "how=none"});
    auto source = swarm.drone("ticker", "source", {"fps=30"});
    for (const auto* receiver : {"one", "two", "well"})
        connect(application, receiver, "image", {.transfer = Transfer::streaming});
    input_from(failures(application, "one").at(0), 5);
    input_from(failures(application, "two").at(0), 9);
    swarm.hivectl_done({"replace", "well"});
    swarm.hivectl_done({"stop", "well"});
    CHECK(application.failing() == std::vector<std::string>{"one", "two"});
    application.stop("source");
    CHECK(application.failures("two").size() == 1);
    const auto again = swarm.hivectl({"rerun", "one"}, 30s);
    CHECK(again.exit_code == 9);
    CHECK(again.out == "one died: ended with exit code 3\n");
}

TEST_CASE("failures: of inputs that belong together the whole set is kept, whether the drone throws or dies")
{
    for (const auto* how : {"throw", "null"}) {
        CAPTURE(how);
        const Swarm swarm;
        auto application = swarm.application();
        auto victim = swarm.drone("breaker", "victim", {"matched=true", "from=6", std::string("how=") + how});
        const auto source = swarm.drone("ticker", "source", {"fps=20"});
        const auto worker = swarm.drone("sleeper", "worker");
        connect(application, "victim", "left", {.transfer = Transfer::streaming});
        application.connect({"worker", "result"}, {"victim", "right"}, {.transfer = Transfer::streaming});
        connect(application, "worker", "image", {.transfer = Transfer::streaming});
        std::vector<KeptFailure> kept;
        REQUIRE(eventually([&] {
            kept = application.failures("victim", true);
            return !kept.empty() && kept[0].inputs.front().input != kept[0].inputs.back().input;
        }));
        CHECK((kept.size() == 1 || std::string(how) == "throw"));
        std::set<std::pair<std::string, std::int64_t>> inputs;
        for (const auto& input : kept[0].inputs)
            inputs.insert({input.input, input.identity.sequence});
        CHECK(std::ranges::any_of(inputs, [&](const auto& one) {
            return one.first == "left" && one.second >= 6 && inputs.contains({"right", one.second});
        }));
        const auto again = swarm.hivectl({"rerun", "victim"}, 30s);
        CAPTURE(again.err);
        CHECK(again.exit_code == 9);
        CHECK(again.out.starts_with(std::string(how) == "throw" ? "victim threw: failed: broken, as told"
                                                                : "victim died: SIGSEGV in breaker::"));
    }
}
