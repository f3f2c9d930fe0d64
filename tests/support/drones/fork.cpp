// A drone for tests with two outputs that forward each event; on request its code is slow, or throws something other
// than an exception.
#include <hive/drone.hpp>

#include <chrono>
#include <thread>

namespace {

using namespace std::chrono_literals;

void fork_drone(hive::Drone& drone)
{
    int mark = 0, marked = 0, slow_ms = 0;
    std::string bomb = "none";
    bool thrown = false;
    drone.parameter("mark", mark, hive::anything(), "a number that does nothing");
    drone.parameter("slow_ms", slow_ms, hive::between(0, 600'000).in("ms"), "how long another mark takes to apply");
    drone.parameter("bomb", bomb, hive::one_of({"none", "main", "change", "event"}),
                    "where an int is thrown, once; in change: each time");
    const auto left = drone.output("left", "application/json", "in the header: seq and index of the input, no boxes"),
               right = drone.output("right", "application/json", "the same");
    drone.on_change([&] {
        if (mark != marked)
            std::this_thread::sleep_for(std::chrono::milliseconds(slow_ms));
        marked = mark;
        thrown = false;
        if (bomb == "change")
            throw 42;
    });
    const auto throw_once = [&](const char* where) {
        if (bomb == where && !std::exchange(thrown, true))
            throw 42;
    };
    drone.on_event(
        "in", "*/*",
        [&](const hive::Event& event) {
            throw_once("event");
            // An empty list of boxes, so that a tracker accepts it.
            const hive::Json header{{"seq", event.identity.sequence},
                                    {"index", event.header.value("index", std::int64_t{0})},
                                    {"boxes", hive::Json::array()}};
            left.emit(header);
            right.emit(header);
        },
        "anything");
    drone.main([&]() -> std::chrono::microseconds {
        throw_once("main");
        return 1s;
    });
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"fork", "Gives each event on at two outputs, for tests."}, fork_drone);
}
