// The running swarm matches its file: each option of a connection is changed, added and removed, one by one and in
// pairs, while sources on demand run, which lose and repeat nothing.
#include "worker_swarm.hpp"

#include <doctest/doctest.h>
#include <hive/application.hpp>
#include <hive/connection_option.hpp>
#include <hive/swarm_plan.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// A value for each option of a connection, by its name; some need another option.
const Json changes{{"share", {{"share", true}}},
                   {"stream", {{"stream", true}}},
                   {"notify", {{"notify", true}}},
                   {"window", {{"window", 4}}},
                   {"first_frame", {{"first_frame", true}}},
                   {"group", {{"group", "g"}}},
                   {"lease", {{"lease", 5}, {"group", "g"}}},
                   {"encoding", {{"encoding", "png"}}}};

bool is_allowed(const Json& change)
{
    return std::ranges::none_of(hive::connection_clashes(), [&](const hive::ConnectionClash& clash) {
        return change.contains(clash.one) && change.contains(clash.other);
    });
}

/// Each of them and none again, and each pair.
/// @param encoded  only those with an encoding, which not all sources have; otherwise all others
std::vector<Json> changes_of(bool encoded)
{
    std::vector<Json> all;
    const auto add = [&](const Json& change) {
        if (change.contains("encoding") == encoded && is_allowed(change) && std::ranges::find(all, change) == all.end())
            all.push_back(change);
    };
    for (auto one = changes.begin(); one != changes.end(); ++one) {
        add(*one);
        for (auto other = std::next(one); !sanitized() && other != changes.end(); ++other) {
            auto both = *one;
            both.update(*other);
            add(both);
        }
    }
    return all;
}

/// Two receivers of one output, and two connections between one pair of drones: the first of each is changed.
Json file_with(const Json& source, const Json& change = Json::object())
{
    Json first{{"from", "one"}, {"to", "a"}}, left{{"from", "two"}, {"to", "join.left"}};
    first.update(change);
    left.update(change);
    return {{"swarm", "s"},
            {"drones",
             {{"one", source},
              {"two", source},
              {"a", {{"kind", "sleeper"}}},
              {"b", {{"kind", "sleeper"}}},
              {"join", {{"kind", "join"}}}}},
            {"connections", {first, {{"from", "one"}, {"to", "b"}}, left, {{"from", "two"}, {"to", "join.right"}}}}};
}

/// The connections as both ends, hivectl connections and the export report them.
Json told(const Swarm& swarm, hive::Application& application)
{
    Json inputs = Json::array(), edges = Json::array(), rows = Json::array();
    for (const auto& answer : application.status(std::vector<std::string>{"a", "b", "join", "one", "two"})) {
        const auto status = value_or_none(answer.status);
        for (const auto& input : status.inputs)
            inputs.push_back({answer.drone, input.input, input.from, input.connected, to_json(input.options)});
        for (const auto& output : status.outputs)
            for (const auto& edge : output.edges)
                if (edge.connected && !edge.group && !edge.receiver.starts_with("app-"))
                    edges.push_back({answer.drone, edge.receiver, edge.encoding, to_json(edge.options)});
    }
    for (const auto& row : Json::parse(swarm.hivectl_done({"connections", "--json", "--timeout", "10"})))
        if (row.at("state") == "connected" && row.at("known_by") == "both")
            for (auto& to = rows.emplace_back();
                 const auto* key : {"from", "to", "kind", "group", "transfer", "delivery", "window", "encoding"})
                to[key] = row.at(key);
    for (auto* list : {&inputs, &edges, &rows})
        std::sort(list->begin(), list->end());
    auto exported = hive::read_swarm(swarm.hivectl_done({"export"})).plan;
    std::ranges::sort(exported.connections, {}, [](const auto& one) { return to_text(one.from) + to_text(one.to); });
    return {{"inputs", inputs}, {"edges", edges}, {"connections", rows}, {"export", to_text(exported)}};
}

/// The same for a swarm that is started from this file.
Json told_anew(const Json& content)
{
    const Swarm fresh;
    const File file(fresh, content);
    steps(fresh, file);
    auto application = fresh.application();
    Json now;
    CHECK(eventually([&] { return (now = told(fresh, application)).at("inputs").size() == 4; }));
    return now;
}

/// Takes the results of a drone slowly, so that its source waits for them.
class Results {
public:
    Results(const Swarm& swarm, const std::vector<hive::Endpoint>& outputs)
        : application_(swarm.application()), collector_(application_.collect(outputs))
    {
    }

    /// The number of the newest event.
    [[nodiscard]] std::int64_t newest()
    {
        const std::lock_guard lock(mutex_);
        return taken_.empty() ? 0 : taken_.rbegin()->first;
    }
    /// Those of the first events that gave no results, or not `each`, with their number.
    [[nodiscard]] std::map<std::int64_t, int> wrong(std::int64_t events, int each)
    {
        const std::lock_guard lock(mutex_);
        std::map<std::int64_t, int> counts;
        for (std::int64_t event = 1; event <= events; ++event)
            if (taken_[event] != each)
                counts[event] = taken_[event];
        return counts;
    }

private:
    void take(const std::stop_token& stop)
    {
        for (; !stop.stop_requested(); std::this_thread::sleep_for(5ms))
            if (const auto event = collector_->next(10ms)) {
                const std::lock_guard lock(mutex_);
                ++taken_[event->identity.sequence];
            }
    }

    hive::Application application_;
    std::unique_ptr<hive::Collector> collector_;
    std::mutex mutex_;
    std::map<std::int64_t, int> taken_;
    std::jthread taker_{[this](const std::stop_token& stop) { take(stop); }};
};

/// A swarm of the file that is brought up with one change after the other.
class Changing {
public:
    explicit Changing(Json source) : source_(std::move(source)) {}

    /// Compares it with a swarm that is started from the changed file.
    void bring_up(const Json& change)
    {
        CAPTURE(change.dump());
        const auto content = file_with(source_, change);
        if (!expected_.contains(change))
            expected_[change] = told_anew(content);
        file_.write(content);
        const auto announced = swarm_.hivectl_done({"up", file_, "--dry-run"});
        CHECK_EQ(swarm_.hivectl_done({"up", file_}, 60'000ms), announced);
        CHECK_EQ(swarm_.hivectl_done({"up", file_}), "");
        for (auto* one : all_)
            CHECK(eventually([&, before = one->newest()] { return one->newest() > before; }));
        // A receiver that leaves a group finishes its work there.
        const bool same = eventually([&] { return told(swarm_, application_) == expected_[change]; });
        CHECK_MESSAGE(same, Json::diff(told(swarm_, application_), expected_[change]).dump());
    }
    void check_no_event_is_lost()
    {
        const std::array<std::int64_t, 3> events{a_.newest(), b_.newest(), join_.newest()};
        constexpr std::int64_t on_the_way = 200;  // of the newest events, to the other input and to this test
        for (std::size_t i = 0; i < events.size(); ++i)
            CHECK(eventually([&] { return all_[i]->newest() > events[i] + on_the_way; }));
        using None = std::map<std::int64_t, int>;
        CHECK_EQ(Json(a_.wrong(events[0], 1)), Json(None()));
        CHECK_EQ(Json(b_.wrong(events[1], 1)), Json(None()));
        CHECK_EQ(Json(join_.wrong(events[2], 2)), Json(None()));
    }

private:
    Json source_;
    std::map<Json, Json> expected_;
    Swarm swarm_;
    File file_{swarm_, file_with(source_)};
    std::vector<std::string> begun_ = steps(swarm_, file_);
    hive::Application application_{swarm_.application()};
    Results a_{swarm_, {{"a", "result"}}}, b_{swarm_, {{"b", "result"}}}, join_{swarm_, {{"join", "counts"}}};
    std::array<Results*, 3> all_{&a_, &b_, &join_};
};

/// @param encoded  as changes_of()
void bring_up_all(const Json& source, bool encoded)
{
    Changing swarm(source);
    const auto bring_up = [&](bool notified) {
        for (const auto& change : changes_of(encoded))
            if (change.contains("notify") == notified) {
                swarm.bring_up(change);
                if (std::ranges::find(changes, change) != changes.end())
                    swarm.bring_up(Json::object());
            }
    };
    bring_up(false);
    swarm.check_no_event_is_lost();
    bring_up(true);  // a source waits for no receiver of notifications
}

}  // namespace

TEST_CASE("up: each option of a connection that a file changes runs as in a swarm that is started from the new file")
{
    for (const auto& option : hive::connection_option_table())
        CHECK_MESSAGE(changes.contains(option.name), option.name, " is not tried");
    bring_up_all({{"kind", "ticker"}, {"set", {{"pace", "demand"}}}}, false);
}

TEST_CASE("up: an encoding that a file changes, alone or with another option, runs as in a fresh swarm")
{
    bring_up_all({{"kind", "camera"}, {"set", {{"pace", "demand"}, {"width", 64}, {"height", 64}}}}, true);
}

TEST_CASE("up: drones that a changed file restarts lose and repeat nothing of a source on demand")
{
    const auto content = [](const Json& restarted, int round) {
        auto file = file_with({{"kind", "ticker"}, {"set", {{"pace", "demand"}}}}, Json::object());
        for (const auto& drone : restarted)
            file["drones"][drone.get<std::string>()]["log_level"] = round % 2 == 0 ? "debug" : "warning";
        return file;
    };
    const Swarm swarm;
    const File file(swarm, content(Json::array(), 0));
    steps(swarm, file);
    Results results(swarm, {{"a", "result"}, {"b", "result"}});
    Results join(swarm, {{"join", "counts"}});
    const auto passed = [](Results& all, std::int64_t event) {
        return eventually([&] { return all.newest() > event + 200; });
    };
    for (int round = 0; round < 6; ++round) {
        file.write(content(round % 3 == 0 ? Json{"a"} : round % 3 == 1 ? Json{"a", "b"} : Json{"join"}, round));
        CHECK_FALSE(steps(swarm, file).empty());
        CHECK(steps(swarm, file).empty());
    }
    const auto of_results = results.newest(), of_join = join.newest();
    CHECK(passed(results, of_results));
    CHECK(passed(join, of_join));
    CHECK_EQ(Json(results.wrong(of_results, 2)), Json(std::map<std::int64_t, int>()));
    CHECK_EQ(Json(join.wrong(of_join, 2)), Json(std::map<std::int64_t, int>()));
}

TEST_CASE("up: Ctrl-C while receivers are being restarted loses and repeats nothing of a source on demand")
{
    const auto content = [](bool other) {
        auto file = file_with({{"kind", "ticker"}, {"set", {{"pace", "demand"}}}}, Json::object());
        for (const char* drone : {"a", "b"})
            file["drones"][drone]["log_level"] = other ? "debug" : "warning";
        return file;
    };
    bool other = false;
    const Swarm swarm;
    const File file(swarm, content(other));
    steps(swarm, file);
    Results results(swarm, {{"a", "result"}, {"b", "result"}});
    Results join(swarm, {{"join", "counts"}});
    const auto passed = [](Results& all, std::int64_t event) {
        return eventually([&] { return all.newest() > event + 200; });
    };
    int undone = 0;
    for (int round = 1; round <= 8; ++round) {
        file.write(content(!other));
        auto up = swarm.hivectl_running({"up", file}, "up");
        std::this_thread::sleep_for(25ms * round);  // during the comparison, the stops, or the starts
        up.signal(SIGINT);
        const auto exit = up.wait(patient(20'000ms));
        CHECK_MESSAGE((exit == 0 || exit == 130), swarm.log("up"));
        undone += exit == 130 ? 1 : 0;
        other = other != (exit == 0);
    }
    CHECK(undone > 0);
    const auto of_results = results.newest(), of_join = join.newest();
    CHECK(passed(results, of_results));
    CHECK(passed(join, of_join));
    CHECK_EQ(Json(results.wrong(of_results, 2)), Json(std::map<std::int64_t, int>()));
    CHECK_EQ(Json(join.wrong(of_join, 2)), Json(std::map<std::int64_t, int>()));
}

TEST_CASE("up: a source that a changed file restarts waits for the receivers that the same change adds")
{
    auto content = file_with({{"kind", "ticker"}, {"set", {{"pace", "demand"}}}});
    const Swarm swarm;
    const File file(swarm, content);
    steps(swarm, file);
    const Results others(swarm, {{"a", "result"}, {"b", "result"}});
    content["drones"]["one"]["log_level"] = "debug";
    content["drones"]["c"] = {{"kind", "sleeper"}};
    content["connections"].push_back({{"from", "one"}, {"to", "c"}});
    file.write(content);
    steps(swarm, file);
    Results added(swarm, {{"c", "result"}});
    CHECK(eventually([&] { return added.newest() > 50; }));
    CHECK_EQ(Json(added.wrong(20, 1)), Json(std::map<std::int64_t, int>()));
}

TEST_CASE("up: members that change their group, and are restarted meanwhile, lose and repeat nothing of a source on "
          "demand")
{
    const auto content = [](const Json& change, const Json& restarted) {
        auto file = file_with({{"kind", "ticker"}, {"set", {{"pace", "demand"}}}}, change);
        file["connections"].erase(1);
        file["connections"][0]["to"] = Json::array({"a", "b"});
        for (const auto& drone : restarted)
            file["drones"][drone.get<std::string>()]["log_level"] = "debug";
        return file;
    };
    const Swarm swarm;
    const File file(swarm, content({{"share", true}}, {}));
    steps(swarm, file);
    auto application = swarm.application();
    Results members(swarm, {{"a", "result"}, {"b", "result"}}), join(swarm, {{"join", "counts"}});
    const auto bring_up = [&](const Json& change, const Json& restarted) {
        CAPTURE(change.dump());
        const auto next = content(change, restarted);
        file.write(next);
        CHECK_FALSE(steps(swarm, file).empty());
        CHECK(steps(swarm, file).empty());
        const auto expected = told_anew(next);
        CHECK(eventually([&] { return told(swarm, application) == expected; }));
    };
    const auto none = Json::array();
    bring_up({{"group", "g"}}, none);
    bring_up({{"group", "h"}, {"window", 4}}, {"a"});
    bring_up({{"share", true}}, {"a", "b"});
    bring_up({{"group", "g"}, {"lease", 5}}, {"b"});
    const auto of_members = members.newest(), of_join = join.newest();
    const auto passed = [](Results& results, std::int64_t event) {
        return eventually([&] { return results.newest() > event + 200; });
    };
    CHECK(passed(members, of_members));
    CHECK(passed(join, of_join));
    CHECK_EQ(Json(members.wrong(of_members, 1)), Json(std::map<std::int64_t, int>()));
    CHECK_EQ(Json(join.wrong(of_join, 2)), Json(std::map<std::int64_t, int>()));
    bring_up({{"group", "h"}}, {"one", "two"});  // they begin again with the first event
}
