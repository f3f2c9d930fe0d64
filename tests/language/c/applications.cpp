// Applications in C: several threads at once, waiting, errors with advice.
#include "world.hpp"

#include <vector>

using namespace world;

namespace {

hive_drone* quiet_drone(const char* kind)
{
    auto* drone = new_drone(kind);
    hive_output* output = nullptr;
    REQUIRE(hive_drone_output(drone, "out", "a/b", "nothing", &output) == HIVE_OK);
    hive_release(output);
    REQUIRE(hive_drone_on_event(
                drone, "in", "a/b,application/json", "anything",
                [](void*, const hive_event*) -> hive_code { return HIVE_OK; }, nullptr)
            == HIVE_OK);
    return drone;
}

}  // namespace

TEST_CASE("c: a call that waits ends when its thread is asked and no longer wants to")
{
    const Home home;
    auto* drone = new_drone("busy");
    int variable = 1;
    REQUIRE(hive_drone_integer(drone, "n", &variable, nullptr, "") == HIVE_OK);
    REQUIRE(hive_drone_start(drone) == HIVE_OK);  // and nobody lets it work, so a set is not answered
    hive_application* application = nullptr;
    REQUIRE(hive_application_new(R"({"timeout_ms": 600000})", &application) == HIVE_OK);
    Text place;
    CHECK(hive_default_home(nullptr) == HIVE_INVALID_ARGUMENT);
    REQUIRE(hive_default_home(place.place()) == HIVE_OK);
    CHECK(place.text() == home.path);
    static int asked;
    asked = 0;
    const auto third_time = [](void* user) -> hive_code {
        return ++*static_cast<int*>(user) == 3 ? hive_fail(HIVE_FAILED, "no") : HIVE_OK;
    };
    REQUIRE(hive_on_wait(third_time, &asked) == HIVE_OK);
    CHECK(hive_application_set(application, "busy", R"({"n": 2})", nullptr) == HIVE_STOPPED);
    CHECK(error().find("cancelled") != std::string::npos);
    CHECK(asked == 3);
    asked = 0;
    CHECK(hive_application_wait(application, "busy", "halted", 600'000) == HIVE_STOPPED);
    asked = 0;
    Text result;
    CHECK(hive_application_set_all(application, R"(["busy"])", R"({"n": 3})", nullptr, nullptr, result.place())
          == HIVE_OK);
    CHECK(result.json().at("changed") == "none");
    REQUIRE(hive_on_wait(nullptr, nullptr) == HIVE_OK);
    CHECK(hive_application_timeout(application, 1) == HIVE_OK);
    CHECK(hive_application_set(application, "busy", R"({"n": 2})", nullptr) == HIVE_TIMEOUT);
    CHECK(variable == 1);
    hive_release(application);
    hive_release(drone);
}

TEST_CASE("c: drones are found, described and awaited; what is wrong has a code, a text and an advice")
{
    const Home home;
    auto* application = new_application();
    Text text;
    REQUIRE(hive_application_drones(application, text.place(), nullptr) == HIVE_OK);
    CHECK(text.json() == Json::array());
    CHECK(hive_application_wait(application, "quiet", "running", 30) == HIVE_TIMEOUT);
    CHECK(hive_application_wait(application, "quiet", "gone", 1000) == HIVE_OK);
    CHECK(hive_application_wait(application, "quiet", "happy", 30) == HIVE_INVALID_ARGUMENT);
    Running running(quiet_drone("quiet"));
    await(application, "quiet");
    REQUIRE(hive_application_find(application, "q*", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json() == Json{"quiet"});
    CHECK(hive_application_find(application, "quite", text.place(), nullptr) == HIVE_NOT_FOUND);
    CHECK(std::string(hive_error_advice()).find("quiet") != std::string::npos);
    REQUIRE(hive_application_describe(application, "quiet", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("outputs").at(0).at("name") == "out");
    REQUIRE(hive_application_status(application, "quiet", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("kind") == "quiet");
    CHECK(hive_application_connect(application, "quiet", "quiet", R"({"widnow": 2})", nullptr)
          == HIVE_INVALID_ARGUMENT);
    CHECK(error().find("widnow") != std::string::npos);
    CHECK(hive_application_connect(application, "quiet", "quiet", R"({"window": 99})", nullptr)
          == HIVE_INVALID_ARGUMENT);
    CHECK(hive_application_put(application, "quiet.in", nullptr, 0, "x", 1, "text/plain") == HIVE_TYPE_MISMATCH);
    CHECK(hive_application_put(application, "quiet", R"({"a": 1})", 8, "x", 1, "a/b") == HIVE_OK);
    CHECK(hive_application_put(application, "quiet", "[]", 2, "x", 1, "a/b") == HIVE_INVALID_ARGUMENT);
    CHECK(hive_application_exception_policy(application, "quiet", "halt") == HIVE_OK);
    CHECK(hive_application_exception_policy(application, "quiet", "never") == HIVE_INVALID_ARGUMENT);
    CHECK(hive_application_halt(application, "quiet") == HIVE_OK);
    CHECK(hive_application_wait(application, "quiet", "halted", 10000) == HIVE_OK);
    CHECK(hive_application_resume(application, "quiet") == HIVE_OK);
    CHECK(hive_application_stop(application, "quiet") == HIVE_OK);
    CHECK(hive_application_wait(application, "quiet", "gone", 10000) == HIVE_OK);
    hive_release(application);
}

TEST_CASE("c: calls of several threads wait for one another, also while one of them waits for events")
{
    const Home home;
    Running running(quiet_drone("quiet"));
    auto* application = new_application();
    await(application, "quiet");
    hive_collector* collector = nullptr;
    REQUIRE(hive_application_collect(application, R"(["quiet"])", nullptr, &collector) == HIVE_OK);
    std::atomic<hive_code> waited = -1;
    std::thread waiter([&] {
        hive_event* event = nullptr;
        waited = hive_collector_next(collector, 3'600'000, &event);
    });
    std::vector<std::thread> threads;
    std::atomic<int> answered = 0;
    for (int i = 0; i < 4; ++i)
        threads.emplace_back([&] {
            for (int j = 0; j < 5; ++j) {
                Text text;
                answered += hive_application_status(application, "quiet", text.place(), nullptr) == HIVE_OK;
            }
        });
    for (auto& thread : threads)
        thread.join();
    CHECK(answered.load() == 20);
    CHECK(waited.load() == -1);
    CHECK(hive_application_close(application) == HIVE_OK);
    waiter.join();
    CHECK(waited.load() == HIVE_STOPPED);
    hive_release(collector);
    hive_release(application);
}

TEST_CASE("c: a call from within a callback of the same application is refused, and what is released there ends")
{
    const Home home;
    Running running(quiet_drone("quiet"));
    struct Inner {
        hive_application* application = new_application();
        hive_collector* collector = nullptr;
        hive_code code = HIVE_OK;
    } inner;
    await(inner.application, "quiet");
    REQUIRE(hive_application_collect(inner.application, R"(["quiet"])", nullptr, &inner.collector) == HIVE_OK);
    const auto cancel = [](void* user) -> hive_code {
        auto& self = *static_cast<Inner*>(user);
        Text text;
        self.code = hive_application_drones(self.application, text.place(), nullptr);
        hive_release(std::exchange(self.collector, nullptr));
        return HIVE_FAILED;
    };
    Text result;
    CHECK(hive_application_set_all(inner.application, R"(["quiet"])", "{}", cancel, &inner, result.place()) == HIVE_OK);
    CHECK(inner.code == HIVE_INVALID_ARGUMENT);
    Text status;
    CHECK(eventually([&] {
        REQUIRE(hive_application_status(inner.application, "quiet", status.place(), nullptr) == HIVE_OK);
        for (const auto& edge : status.json().at("outputs").at(0).value("edges", Json::array()))
            if (edge.value("connected", false))
                return false;
        return true;
    }));
    hive_release(inner.application);
}
