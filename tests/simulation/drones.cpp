// Code of users, running in simulated time.
#include "drones.hpp"
#include "world.hpp"

#include <hive/event/clock.hpp>

#include <memory>
#include <stdexcept>
#include <utility>

namespace hive::simulation {

using namespace std::chrono_literals;

namespace {

struct Source {
    std::string pace = "live";
    double fps = 30;
    int count = 0;
    bool ends = false;
    OnCapture on_capture;
    std::int64_t made = 0, made_before = 0;  ///< in all, and until the last end
    bool ended = false;
    std::optional<Time> next{};

    void change(const Output& tick)
    {
        if (made < count && std::exchange(ended, false))
            tick.begin_source();
    }
    std::chrono::microseconds step(const Output& tick)
    {
        if (made >= count) {
            if (ends && !std::exchange(ended, true)) {
                tick.end();
                made_before = made;
            }
            return 1s;
        }
        if (pace == "demand")
            return tick.asked() ? (emit(tick, true), 0us) : 1s;
        const auto now = world().now();
        if (next && now < *next)
            return std::chrono::ceil<std::chrono::microseconds>(*next - now);
        next = now + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1 / fps));
        emit(tick, false);
        return 0us;
    }
    void emit(const Output& tick, bool lossless)
    {
        ++made;
        const auto us = event::wall_us();
        const auto captured = std::chrono::system_clock::time_point(std::chrono::microseconds(us));
        on_capture(us, made - made_before, made);
        tick.emit_captured(captured, lossless, {{"index", made}}, [] { return Body(std::string(100, 'x')); });
    }
};

struct Worker {
    int work_ms = 0, most_ms = 600'000, throw_every = 0;

    void check() const
    {
        if (work_ms > most_ms)
            throw std::runtime_error("work_ms " + std::to_string(work_ms) + " is more than " + std::to_string(most_ms));
    }
    void work(const Event& event, const Output& result) const
    {
        world().spend(world().between(work_ms * 500us, work_ms * 1500us));
        if (throw_every > 0 && event.identity.sequence % throw_every == 0)
            throw std::runtime_error("event " + std::to_string(event.identity.sequence) + " is one of those");
        result.emit({{"index", event.header.value("index", std::int64_t{0})}});
    }
};

}  // namespace

void source(Drone& drone)
{
    source(drone, [](auto, auto, auto) {});
}

void source(Drone& drone, OnCapture on_capture)
{
    const auto self = std::make_shared<Source>();
    self->on_capture = std::move(on_capture);
    drone.parameter("pace", self->pace, one_of({"live", "demand"}), "");
    drone.parameter("fps", self->fps, between(0.1, 100'000), "");
    drone.parameter("count", self->count, at_least(0), "how many in all");
    drone.parameter("ends", self->ends, {}, "the last of them is the end");
    const auto tick = drone.output("tick", "application/octet-stream", "");
    drone.on_change([self, tick] { self->change(tick); });
    drone.main([self, tick] { return self->step(tick); });
}

void worker(Drone& drone)
{
    const auto self = std::make_shared<Worker>();
    drone.parameter("work_ms", self->work_ms, between(0, 600'000), "");
    drone.parameter("most_ms", self->most_ms, at_least(0), "a longer work_ms is refused");
    drone.parameter("throw_every", self->throw_every, at_least(0), "");
    const auto result = drone.output("result", "application/json", "");
    drone.on_change([self] { self->check(); });
    drone.on_event("image", "*/*", [self, result](const Event& event) { self->work(event, result); });
}

}  // namespace hive::simulation
