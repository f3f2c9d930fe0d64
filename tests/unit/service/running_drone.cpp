// Drones that run inside the test: what they do with whatever their code throws, and how they end themselves.
#include <hive/application.hpp>
#include <hive/drone.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iostream>
#include <sstream>
#include <thread>

namespace {

using namespace std::chrono_literals;
using hive::Drone;
using hive::Json;

constexpr const char* not_an_exception = "a non-exception object was thrown";

/// A home of its own for the drones of one test.
class Home {
public:
    Home()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "hive-unit-service-XXXXXX").string();
        REQUIRE(::mkdtemp(pattern.data()));
        directory_ = pattern;
        ::setenv("HIVE_HOME", pattern.c_str(), 1);
    }
    ~Home() { std::filesystem::remove_all(directory_); }
    Home(const Home&) = delete;
    Home& operator=(const Home&) = delete;

    [[nodiscard]] bool has(const std::string& file) const { return std::filesystem::exists(directory_ / file); }
    void write(const std::string& file, const Json& json) const { std::ofstream(directory_ / file) << json; }
    [[nodiscard]] Json read(const std::string& file) const
    {
        std::ifstream stream(directory_ / file);
        return Json::parse(stream);
    }

private:
    std::filesystem::path directory_;
};

int run_drone(const std::function<void(Drone&)>& body)
{
    std::string program = "hive-subject", option = "--log-level", level = "off";
    char* words[] = {program.data(), option.data(), level.data(), nullptr};
    return hive::run_drone(3, words, {"subject", "A drone under test."}, body);
}

/// A drone in a thread of its own, which is its user thread; told to stop at the end.
class Running {
public:
    /// Returns when it answers.
    explicit Running(std::function<void(Drone&)> declare)
        : thread_([this, declare = std::move(declare)] {
              exit_code_.set_value(run_drone([&](Drone& drone) {
                  declare(drone);
                  drone.on_start([&] { drone_.set_value(&drone); });
                  drone.run();
              }));
          })
    {
        auto future = drone_.get_future();
        REQUIRE(future.wait_for(10s) == std::future_status::ready);
        handle_ = future.get();
    }
    ~Running()
    {
        if (thread_.joinable()) {
            handle_->stop();
            thread_.join();
        }
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    /// Waits for it to end by itself.
    int exit_code()
    {
        auto future = exit_code_.get_future();
        REQUIRE(future.wait_for(10s) == std::future_status::ready);
        thread_.join();
        return future.get();
    }

private:
    std::promise<Drone*> drone_;
    std::promise<int> exit_code_;
    Drone* handle_ = nullptr;
    std::thread thread_;
};

/// Asks until the drone answers and the answer pleases.
template <class Condition>
Json status_when(hive::Application& application, Condition condition)
{
    for (const auto end = std::chrono::steady_clock::now() + 10s; std::chrono::steady_clock::now() < end;) {
        const auto answer = application.status(std::vector<std::string>{"subject"}).front();
        if (const auto* known = value_of(answer.status))
            if (const Json status = to_json(*known); condition(status))
                return status;
        std::this_thread::sleep_for(3ms);
    }
    FAIL("the drone did not come to what was waited for");
    return {};
}

bool idle(const Json& status) { return status["state"] == "idle"; }

/// Is a set of it refused with "nothing was set"? A tenth of a second before the asker gives up the drone says so; what
/// comes later than that is not known, and is asked again.
bool is_not_set(hive::Application& application, int value)
{
    for (int i = 0; i < 3; ++i)
        try {
            application.set("subject", {{"value", value}});
            return false;
        } catch (const hive::Error& error) {
            MESSAGE(error.what());
            if (std::string(error.what()).find("nothing was set") != std::string::npos)
                return true;
        }
    return false;
}

}  // namespace

TEST_CASE("running drone: what main throws is reported, even if it is not an exception, and main is called again")
{
    const Home home;
    std::atomic<int> calls{0};
    const Running drone([&](Drone& subject) {
        subject.main([&]() -> std::chrono::microseconds {
            if (++calls == 1)
                throw 42;
            return 1s;
        });
    });
    hive::Application application;
    const auto status = status_when(application, [&](const Json& now) { return calls > 1 && now["state"] == "idle"; });
    CHECK(status.at("last_exception").at("code") == "failed");
    CHECK(status.at("last_exception").at("text") == not_an_exception);
}

TEST_CASE("running drone: a set that on_change answers by throwing something is refused, and the old value is back")
{
    const Home home;
    int value = 1;
    const Running drone([&](Drone& subject) {
        subject.parameter("value", value, hive::anything(), "a number below 10");
        subject.on_change([&] {
            if (value >= 10)
                throw 42;
        });
    });
    hive::Application application;
    status_when(application, idle);
    CHECK_THROWS_WITH_AS(application.set("subject", {{"value", 10}}), doctest::Contains(not_an_exception), hive::Error);
    CHECK(application.get("subject").at("value") == 1);
    CHECK(application.set("subject", {{"value", 9}}).at("value") == 9);
}

TEST_CASE("running drone: on_change that throws at the old values as well is reported, and the set is refused with the "
          "first reason")
{
    const Home home;
    int value = 1;
    const Running drone([&](Drone& subject) {
        subject.parameter("value", value, hive::anything(), "");
        subject.on_change([&, calls = 0]() mutable {
            if (++calls > 1)
                throw std::runtime_error(value == 2 ? "the first reason" : "the second reason");
        });
    });
    hive::Application application;
    status_when(application, idle);
    CHECK_THROWS_WITH_AS(application.set("subject", {{"value", 2}}), doctest::Contains("the first reason"),
                         hive::Error);
    CHECK(application.get("subject").at("value") == 1);
    const auto status = status_when(application, [](const Json& now) { return now.contains("last_exception"); });
    CHECK(status.at("last_exception").at("text") == "the second reason");
}

TEST_CASE("running drone: a set is answered at its deadline while on_change still works, and is put back then")
{
    const Home home;
    int value = 1;
    std::atomic<bool> busy{false}, go_on{false};
    std::atomic<int> seen{0};
    const Running drone([&](Drone& subject) {
        subject.parameter("value", value, hive::anything(), "");
        subject.on_change([&] {
            seen = value;
            if (value == 2) {
                busy = true;
                go_on.wait(false);
            }
        });
    });
    hive::Application application({.name = {}, .home = {}, .timeout = 3s});
    status_when(application, idle);
    CHECK(is_not_set(application, 2));
    CHECK(busy);
    CHECK(application.get("subject").at("value") == 1);
    go_on = true;
    go_on.notify_all();
    application.timeout(10s);
    CHECK(application.set("subject", {{"value", 3}}).at("value") == 3);  // after what was put back
    CHECK(application.set("subject", Json::object()).empty());
    CHECK(seen == 3);
}

TEST_CASE("running drone: a set whose deadline has passed before its turn came does nothing then")
{
    const Home home;
    int value = 1;
    std::atomic<bool> busy{false}, go_on{false};
    std::atomic<int> changes{0};
    const Running drone([&](Drone& subject) {
        subject.parameter("value", value, hive::anything(), "");
        subject.on_change([&] { ++changes; });
        subject.main([&]() -> std::chrono::microseconds {
            busy = true;
            go_on.wait(false);
            return 1h;
        });
    });
    while (!busy)
        std::this_thread::yield();
    const int before = changes;
    hive::Application application({.name = {}, .home = {}, .timeout = 2s});
    status_when(application, [](const Json&) { return true; });  // connected: the deadline is all the set's
    const auto begin = std::chrono::steady_clock::now();
    CHECK(is_not_set(application, 2));
    CHECK(std::chrono::steady_clock::now() - begin < 20s);
    go_on = true;
    go_on.notify_all();
    application.timeout(10s);
    CHECK(application.set("subject", Json::object()).empty());
    CHECK(application.get("subject").at("value") == 1);
    CHECK(changes == before + 1);  // of the empty set alone
}

TEST_CASE("running drone: whatever on_start throws, the drone ends and says why")
{
    const Home home;
    std::ostringstream said;
    auto* const before = std::cerr.rdbuf(said.rdbuf());
    const int exit_code = run_drone([](Drone& drone) {
        drone.on_start([] { throw 42; });
        drone.run();
    });
    std::cerr.rdbuf(before);
    CHECK(exit_code == 1);
    CHECK(said.str() == std::string("hive-subject: ") + not_an_exception + "\n");
}

TEST_CASE("running drone: a drone whose world has ended stops itself and leaves nothing behind")
{
    const Home home;
    Running drone([](Drone& subject) {
        subject.main([&]() -> std::chrono::microseconds {
            subject.stop();
            return 1h;
        });
    });
    CHECK(drone.exit_code() == 0);
    CHECK_FALSE(home.has("subject.sock"));
    CHECK_FALSE(home.has("subject.state"));
}

TEST_CASE("running drone: after a crash it knows what its receivers have missed, and writes that down again")
{
    const Home home;
    const Json subscribers = Json::parse(R"([
        {"output": "out", "receiver": "waits.in", "missed": {"events": 2, "source": "camera", "epoch": 7}},
        {"output": "out", "receiver": "away.in", "missed": {"events": 3, "source": "camera", "epoch": 7},
         "dormant": true}])");
    home.write("subject.state", {{"kind", "subject"}, {"subscribers", subscribers}});
    const Running drone([](Drone& subject) { subject.output("out", "text/plain"); });
    hive::Application application;
    status_when(application, idle);
    CHECK(home.read("subject.state")["subscribers"] == subscribers);
}

TEST_CASE("running drone: its epoch grows past the one it left, and one that no clock makes is ignored")
{
    const std::int64_t in_2200 = 7'258'118'400'000'000;
    const auto epoch_after = [](const Json& left) {
        const Home home;
        home.write("subject.state", {{"kind", "subject"}, {"epoch", left}});
        const Running drone([](Drone&) {});
        hive::Application application;
        status_when(application, idle);
        return home.read("subject.state")["epoch"].get<std::int64_t>();
    };
    const std::int64_t in_2100 = 4'102'444'800'000'000;
    constexpr std::int64_t most_ends = 1 << 20;  // each end of a source takes an epoch, too
    CHECK(epoch_after(in_2100) == in_2100 + most_ends);
    for (const Json& left : {Json("yesterday"), Json(-1), Json(in_2200), Json(std::int64_t{1} << 53)})
        CHECK_MESSAGE(epoch_after(left) < in_2100, left.dump());
}

TEST_CASE("running drone: stop() before run() is refused")
{
    const Home home;
    CHECK(run_drone([](Drone& drone) { CHECK_THROWS_AS(drone.stop(), hive::Error); }) == 0);
}

namespace {

/// The drone's answer, or what it said instead.
std::string outcome_of(const std::function<void()>& request)
{
    try {
        request();
        return "done";
    } catch (const hive::Error& error) {
        return std::string(info(error.code()).token) + ": " + error.what();
    }
}

}  // namespace

TEST_CASE("running drone: texts of any length leave it as much as a reader takes, and it is reached all the same")
{
    const Home home;
    const std::string endless(60'000, 'x');
    std::string way, value;
    const Running drone([&](Drone& subject) {
        subject.parameter("way", way, hive::anything(), "");
        subject.parameter("value", value, hive::anything(), "");
        subject.on_change([&] {
            if (way == "throws")
                throw std::runtime_error(endless);
            value = way == "grows" ? endless : "small";
            subject.condition(way == "says" ? endless : "");
        });
    });
    hive::Application application;
    status_when(application, idle);
    const auto refused = outcome_of([&] { application.set("subject", {{"way", "throws"}}); });
    CAPTURE(refused.substr(0, 100));
    CHECK(refused.starts_with("refused: "));
    CHECK(refused.size() < 4100);
    const auto too_large = outcome_of([&] { application.set("subject", {{"way", "grows"}}); });
    CHECK(too_large.starts_with("too_large: "));
    CHECK(application.get("subject", {}).at("value") == "small");
    CHECK(outcome_of([&] { application.set("subject", {{"way", "says"}}); }) == "done");
    const Json status =
        status_when(application, [](const Json& now) { return now.value("condition", "").size() > 3900; });
    CHECK(status["condition"].get<std::string>().size() <= 4000);
}
