// hivectl audit: counts of a running swarm never contradict each other, and losses are reported with their place.
#include "swarm.hpp"

#include <hive/event/clock.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <thread>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

struct Audited {
    Json rows;
    int exit_code = -1;
    std::string err;

    [[nodiscard]] Json row(const std::string& to) const
    {
        for (const auto& row : rows)
            if (row.at("to") == to)
                return row;
        return {};
    }
};

Audited audited(const Swarm& swarm)
{
    const auto done = swarm.hivectl({"audit", "--json"});
    return {Json::parse(done.out), done.exit_code, done.err};
}

/// The sum of all fates in the row.
std::int64_t accounted(const Json& row)
{
    std::int64_t sum = 0;
    for (const auto* key : {"acknowledged", "skipped", "dropped", "passed_on", "abandoned", "lost_connection",
                            "lost_killed", "lost_cut_off", "lost_left", "in_flight"})
        sum += row.at(key).get<std::int64_t>();
    return sum;
}

}  // namespace

TEST_CASE("audit: a busy swarm is never said to have lost anything, while receivers come, change and leave")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=2000", "bytes=100"}),
               early = swarm.drone("sleeper", "early"), one = swarm.drone("sleeper", "one"),
               two = swarm.drone("sleeper", "two");
    auto application = swarm.application();
    application.connect({"source", ""}, {"early", ""}, {.window = 8, .group = {}, .lease = {}});
    for (const auto* member : {"one", "two"})
        application.connect({"source", ""}, {member, ""}, {.window = 4, .group = "workers", .lease = {}});
    for (int round = 0; round < 20; ++round) {
        CAPTURE(round);
        if (round % 4 == 1)
            application.disconnect({"source", ""}, {"early", ""});
        if (round % 4 == 2)
            application.connect({"source", ""}, {"early", ""}, {.window = 8, .group = {}, .lease = {}});
        const auto now = audited(swarm);
        CHECK_MESSAGE(now.exit_code == 0, now.rows.dump(2));
        for (const auto& row : now.rows)
            CHECK_MESSAGE(row.at("came") == accounted(row), row.dump(2));
    }
    const auto last = audited(swarm);
    CHECK(last.row("one.image").at("state") == "both ends");
    CHECK(last.row("group workers").at("state") == "group");
    CHECK(last.row("one.image").at("received").get<std::int64_t>() > 100);
}

TEST_CASE("audit: a receiver that is killed, a queue that is full and code that throws are named with their place")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=200"});
    auto worker = swarm.drone("sleeper", "worker", {"work_ms=100"});
    const auto thrower = swarm.drone("sleeper", "thrower", {"throw_at=1"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    REQUIRE(eventually([&] { return application.status("worker").state == hive::State::busy; }));
    CHECK(audited(swarm).exit_code == 0);
    worker.kill();
    Audited killed;
    CHECK_MESSAGE(eventually([&] { return (killed = audited(swarm)).exit_code == 9; }), killed.rows.dump(2));
    const auto gone = killed.row("worker.image");
    CHECK_MESSAGE(gone.at("lost") > 0, gone.dump(2));  // the event in progress, and perhaps one in flight
    CHECK(gone.at("losses").back()
          == Json{{"fate", "lost_killed"},
                  {"at", "source"},
                  {"events", gone.at("lost")},
                  {"promised", true},
                  {"last_us", gone.at("last_lost_us")},
                  {"reason", ""}});
    CHECK(gone.at("state") == "receiver gone");

    application.connect({"source", ""}, {"thrower", ""});
    CHECK(eventually([&] { return audited(swarm).row("thrower.image").value("lost", 0) == 1; }));
    CHECK(has(swarm.hivectl({"audit", "--wide"}).out, "1 abandoned at thrower (last: "));

    application.disconnect({"source", ""}, {"thrower", ""});
    CHECK(eventually([&] {
        return std::ranges::any_of(audited(swarm).rows, [](const Json& row) {
            return row.at("state") == "closed" && row.at("to") == "thrower.image" && row.at("lost") == 1;
        });
    }));

    const auto slow = swarm.drone("sleeper", "slow", {"work_ms=500"});
    application.connect({"source", ""}, {"slow", ""},
                        {.transfer = hive::Transfer::streaming, .group = {}, .lease = {}});
    CHECK(eventually([&] { return audited(swarm).row("slow.image").value("lost", 0) > 0; }));
    CHECK(audited(swarm).row("slow.image").at("verdict") == "lost");
}

TEST_CASE("audit: losses before a time are left out")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    auto killed = swarm.drone("sleeper", "killed", {"work_ms=60000"});
    const auto thrower = swarm.drone("sleeper", "thrower", {"throw_at=1"});
    auto application = swarm.application();
    application.connect({"source", ""}, {"killed", ""});
    application.connect({"source", ""}, {"thrower", ""});
    REQUIRE(eventually([&] { return application.status("killed").state == hive::State::busy; }));
    killed.kill();
    Audited now;
    const auto both_lost = [&] {
        now = audited(swarm);
        return now.row("killed.image").value("lost", 0) > 0 && now.row("thrower.image").value("lost", 0) > 0;
    };
    REQUIRE_MESSAGE(eventually(both_lost), now.rows.dump(2));
    const auto exit_of = [&](const std::string& since) { return swarm.hivectl({"audit", "--since", since}).exit_code; };
    CHECK(exit_of("1h") == 9);
    for (const auto* row : {"killed.image", "thrower.image"}) {
        const auto age_us = hive::event::wall_us() - now.row(row).at("last_lost_us").get<std::int64_t>();
        CHECK(age_us >= 0);
        CHECK(age_us < 60'000'000);
    }
    std::this_thread::sleep_for(1500ms);
    CHECK(audited(swarm).row("killed.image").at("last_lost_us") == now.row("killed.image").at("last_lost_us"));
    CHECK(exit_of("1s") == 0);
    CHECK(has(swarm.hivectl({"audit", "--since", "1s"}).err, "nothing was lost"));
    application.set("thrower", {{"throw_every", 1}});
    CHECK(eventually([&] { return exit_of("10s") == 9; }));
    const auto wrong = swarm.hivectl({"audit", "--since", "yesterday"});
    CHECK(wrong.exit_code == 2);
    CHECK_MESSAGE(has(wrong.err, "yesterday"), wrong.err);
}

TEST_CASE("audit: it says which ends it knows")
{
    const Swarm swarm;
    auto source = swarm.drone("ticker", "source", {"fps=50"});
    const auto worker = swarm.drone("sleeper", "worker");
    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    const auto collector = application.collect({{"worker", "result"}});
    REQUIRE(collector->next(patient(5000ms)));
    CHECK(audited(swarm).row(application.name()).at("state") == "sender only");
    source.kill();
    Audited alone;
    CHECK(eventually([&] { return (alone = audited(swarm)).row("worker.image").value("state", "") == "sender gone"; }));
    CHECK(alone.row("worker.image").at("came").is_null());
    CHECK(alone.exit_code == 0);
    const auto watching = swarm.hivectl_running({"audit", "--watch", "--interval", "0.05"}, "watching");
    CHECK(eventually([&] { return lines_of(swarm.log("watching")) > 8; }));
}
