// A worker for tests: sleeps at each event, throws or refuses on request, and reports what it received.
#include <hive/drone.hpp>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

#include <ctime>

namespace {

/// Checks the body of a ticker: each byte is one more than the one before, and their sum is in the header.
bool as_it_was_sent(const hive::Event& event)
{
    const auto *begin = event.body.data(), *end = begin + event.body.size();
    const auto breaks = [](unsigned char one, unsigned char next) {
        return next != static_cast<unsigned char>(one + 1);
    };
    return std::adjacent_find(begin, end, breaks) == end
           && event.header["sum"] == std::accumulate(begin, end, std::int64_t{0});
}

/// Computes until this thread has used this much processor time.
void burn(std::chrono::nanoseconds time)
{
    const auto used = [] {
        timespec now{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
        return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
    };
    for (const auto end = used() + time; used() < end;) {
    }
}

void sleeper(hive::Drone& drone)
{
    bool emits = true;
    int holds_mb = 0, emits_every = 1, start_ms = 0, work_ms = 0, burn_ms = 0, step_ms = 1, most_ms = 600'000,
        throw_at = 0, thrown_at = 0, hang_from = 0, throw_every = 0;
    drone.parameter("start_ms", start_ms, hive::between(0, 600'000).in("ms"),
                    "how long it takes at the next start until it is ready");
    drone.parameter("work_ms", work_ms, hive::between(0, 600'000).in("ms"), "how long each event takes");
    drone.parameter("burn_ms", burn_ms, hive::between(0, 10'000).in("ms"),
                    "how much processor time each event costs beside that");
    drone.parameter("step_ms", step_ms, hive::at_least(1).in("ms"),
                    "this drone's own code rounds work_ms down to a multiple of it");
    drone.parameter("most_ms", most_ms, hive::at_least(0).in("ms"),
                    "a longer work_ms is refused by this drone's own code");
    drone.parameter("throw_at", throw_at, hive::at_least(0),
                    "throws once, on the first event with this sequence number or a later one; 0: never");
    drone.parameter("throw_every", throw_every, hive::at_least(0),
                    "throws on each event whose sequence number it divides, at every attempt; 0: never");
    drone.parameter("hang_from", hang_from, hive::at_least(0),
                    "hangs at an event with this sequence number or one of the next 49; 0: never");
    drone.parameter("emits", emits, {}, "gives a result for each event");
    drone.parameter("emits_every", emits_every, hive::at_least(1),
                    "gives results only for sequence numbers that it divides");
    drone.parameter("holds_mb", holds_mb, hive::between(0, 10'000).in("MB"), "memory that it uses and does not need");
    std::vector<char> held;
    const auto result = drone.output("result", "application/json",
                                     "in the header: seq and index of the input, its age when the work was done");
    drone.on_start([&] { std::this_thread::sleep_for(std::chrono::milliseconds(start_ms)); });
    drone.on_change([&] {
        if (const auto size = std::size_t(holds_mb) * 1'000'000; size != held.size()) {
            std::vector<char>().swap(held);  // first, so that it never has both
            held.assign(size, 'x');
        }
        work_ms -= work_ms % step_ms;
        if (work_ms > most_ms)
            throw std::runtime_error("work_ms " + std::to_string(work_ms) + " is more than " + std::to_string(most_ms));
    });
    drone.on_event(
        "image", "*/*",
        [&](const hive::Event& event) {
            std::this_thread::sleep_for(std::chrono::milliseconds(work_ms));
            burn(std::chrono::milliseconds(burn_ms));
            while (hang_from > 0 && event.identity.sequence >= hang_from && event.identity.sequence < hang_from + 50)
                std::this_thread::sleep_for(std::chrono::seconds(1));
            if (throw_at != thrown_at && throw_at > 0 && event.identity.sequence >= throw_at) {
                thrown_at = throw_at;
                throw std::runtime_error("event " + std::to_string(event.identity.sequence) + " is not to my taste");
            }
            if (throw_every > 0 && event.identity.sequence % throw_every == 0)
                throw std::runtime_error("event " + std::to_string(event.identity.sequence) + " is one of those");
            if (event.body.size() == event.size && event.header.contains("sum") && !as_it_was_sent(event))
                throw std::runtime_error("the bytes of event " + std::to_string(event.identity.sequence)
                                         + " have changed on the way");
            if (!emits || event.identity.sequence % emits_every != 0)
                return;
            result.emit({{"seq", event.identity.sequence},
                         {"index", event.header.value("index", std::int64_t{0})},
                         {"age_us", event.age().count()}});
        },
        "anything");
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"sleeper", "Sleeps over each event, for tests."}, sleeper);
}
