// Code of users, running in simulated time.
#include "drones.hpp"
#include "world.hpp"

#include <hive/event/clock.hpp>

#include <algorithm>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

namespace hive::simulation {

using namespace std::chrono_literals;

namespace {

constexpr auto halved = "application/half";

char letter(std::int64_t index) { return static_cast<char>('a' + index % 26); }

/// Leaves out the second half.
Event half_of(const Event& event, const std::string&)
{
    Event half = event;
    half.type = halved;
    half.body = Body(std::string(event.body.size() / 2, letter(event.header.at("index"))));
    return half;
}

struct Source {
    std::string pace = "live";
    double fps = 30;
    int count = 0;
    bool ends = false;
    OnCapture on_capture;
    std::function<std::size_t()> sizes;
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
        if (!sizes)
            return tick.emit_captured(captured, lossless, {{"index", made}},
                                      [] { return Body(std::string(100, 'x')); });
        const auto size = sizes();
        tick.emit_captured(captured, lossless, {{"index", made}, {"size", size}},
                           [&] { return Body(std::string(size, letter(made))); });
    }
};

struct Worker {
    int work_ms = 0, most_ms = 600'000, throw_every = 0;

    void check() const
    {
        if (work_ms > most_ms)
            throw std::runtime_error("work_ms " + std::to_string(work_ms) + " is more than " + std::to_string(most_ms));
    }
    std::function<void(const Event&)> on_work;

    void work(const Event& event, const Output& result) const
    {
        world().spend(world().between(work_ms * 500us, work_ms * 1500us));
        if (throw_every > 0 && event.identity.sequence % throw_every == 0)
            throw std::runtime_error("event " + std::to_string(event.identity.sequence) + " is one of those");
        on_work(event);
        if (!event.header.contains("size"))
            return result.emit({{"index", event.header.value("index", std::int64_t{0})}});
        result.emit({{"index", event.header.at("index")}, {"size", event.header.at("size")}}, event.body);
    }
};

}  // namespace

void source(Drone& drone)
{
    source(drone, [](auto, auto, auto) {});
}

void source(Drone& drone, OnCapture on_capture, std::function<std::size_t()> sizes)
{
    const auto self = std::make_shared<Source>();
    self->on_capture = std::move(on_capture);
    drone.parameter("pace", self->pace, one_of({"live", "demand"}), "");
    drone.parameter("fps", self->fps, between(0.1, 100'000), "");
    drone.parameter("count", self->count, at_least(0), "how many in all");
    drone.parameter("ends", self->ends, {}, "the last of them is the end");
    self->sizes = std::move(sizes);
    std::string type = "application/octet-stream";
    Encoder encoder;
    if (self->sizes) {
        type += std::string(",") + halved;
        encoder.encodings.push_back({.word = "half", .type = halved});
        encoder.encode = half_of;
    }
    const auto tick = drone.output("tick", type, "", std::move(encoder));
    drone.on_change([self, tick] { self->change(tick); });
    drone.main([self, tick] { return self->step(tick); });
}

void worker(Drone& drone)
{
    watched_worker(drone, [](const Event&) {});
}

void watched_worker(Drone& drone, std::function<void(const Event&)> on_work)
{
    const auto self = std::make_shared<Worker>();
    self->on_work = std::move(on_work);
    drone.parameter("work_ms", self->work_ms, between(0, 600'000), "");
    drone.parameter("most_ms", self->most_ms, at_least(0), "a longer work_ms is refused");
    drone.parameter("throw_every", self->throw_every, at_least(0), "");
    const auto result = drone.output("result", "application/json", "");
    drone.on_change([self] { self->check(); });
    drone.on_event("image", "*/*", [self, result](const Event& event) { self->work(event, result); });
}

void fork(Drone& drone)
{
    const auto left = drone.output("left", "application/json", ""),
               right = drone.output("right", "application/json", "");
    drone.on_event("in", "*/*", [left, right](const Event& event) {
        const Json header{{"index", event.header.at("index")}};
        left.emit(header);
        right.emit(header);
    });
}

void pair(Drone& drone)
{
    const auto set = drone.output("set", "application/json", "");
    drone.on_matched({{"left", "*/*", ""}, {"right", "*/*", ""}}, Match::exact(),
                     [set](const std::vector<Event>& events) {
                         set.emit({{"index", events[0].header.at("index")}});
                     });
}

std::optional<std::string> wrong_body(const Event& event)
{
    if (!event.header.contains("size"))
        return std::nullopt;
    const auto size = event.header.at("size").get<std::size_t>(), got = event.body.size();
    const auto bytes = event.body.bytes();
    const bool all_same = bytes.empty() || std::memcmp(bytes.data(), bytes.data() + 1, got - 1) == 0;
    if ((got == size || got == size / 2) && all_same
        && (bytes.empty() || bytes.front() == std::byte(letter(event.header.at("index")))))
        return std::nullopt;
    return "body: event " + std::to_string(event.identity.sequence) + " of " + event.sender + " has "
           + std::to_string(got) + " bytes or wrong ones, and its source made " + std::to_string(size);
}

}  // namespace hive::simulation
