// The turn: who runs the network side, and when it changes hands.
#include <hive/event/loop.hpp>

#include <asio/post.hpp>
#include <asio/steady_timer.hpp>
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <stdexcept>
#include <vector>

namespace hive::event {
namespace {

using namespace std::chrono_literals;

constexpr auto long_enough = 20s;  ///< nothing here takes a thousandth of it

const auto self = [] { return std::this_thread::get_id(); };

Clock::time_point in(Clock::duration time) { return Clock::now() + time; }

/// A loop that runs, ended in time for what its handlers refer to.
struct Running {
    Running() { loop.start(); }
    ~Running() { loop.end(); }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    /// Leaves the loop alone until its own thread has the turn, inside a handler that waits for the gate.
    void leave_to_network_thread(std::shared_future<void> gate)
    {
        const auto there = std::make_shared<std::promise<void>>();
        loop.post([there, gate] { there->set_value(), gate.wait_for(long_enough); });
        REQUIRE(there->get_future().wait_for(long_enough) == std::future_status::ready);
    }
    Loop loop;
};

}  // namespace

TEST_CASE("loop: what a handler or a task throws is reported, and the next one runs")
{
    Loop loop;
    std::vector<std::string> thrown;
    loop.on_thrown = [&](const std::string& what) { thrown.push_back(what); };
    bool ran = false;
    asio::post(loop.context(), [] { throw std::runtime_error("handler"); });
    asio::post(loop.context(), [] { throw 1; });
    loop.post([] { throw std::runtime_error("posted"); });
    loop.post([] { throw 2; });
    loop.post([&] { ran = true; });
    loop.serve();
    loop.perform([] { throw std::runtime_error("performed"); });
    CHECK(ran);
    CHECK(thrown
          == std::vector<std::string>{"handler", "no std::exception", "posted", "no std::exception", "performed"});
    CHECK_FALSE(loop.has_turn());
    CHECK_THROWS_AS(loop.call([] { throw std::runtime_error("called"); }), std::runtime_error);
}

TEST_CASE(
    "loop: a thread that finds the turn free runs a task at once, after what was posted, and is served what is ready")
{
    Loop loop;  // without its thread, so the turn is free
    std::vector<int> order;
    loop.post([&] { order.push_back(1); });
    loop.perform([&] {
        order.push_back(2);
        CHECK(loop.has_turn());
    });
    CHECK(order == std::vector{1, 2});
    loop.post([&] { order.push_back(3); });
    loop.serve();
    CHECK(order == std::vector{1, 2, 3});
    CHECK_FALSE(loop.has_turn());
}

TEST_CASE("loop: what is left alone for longer than idle_timeout is run by the network thread, and the turn comes back")
{
    Running running;
    for (int i = 0; i < 20; ++i) {
        std::promise<std::thread::id> other;
        auto taken_over = other.get_future();
        running.loop.post([&] { other.set_value(self()); });
        REQUIRE(taken_over.wait_for(long_enough) == std::future_status::ready);
        CHECK(taken_over.get() != self());
        running.loop.call([&] { CHECK(running.loop.has_turn()); });
        CHECK_FALSE(running.loop.has_turn());
    }
}

TEST_CASE("loop: a thread that waits runs the handlers itself, however long it waits")
{
    Running running;
    std::thread::id by;
    asio::steady_timer timer(running.loop.context());
    bool begun = false;
    running.loop.wait(in(long_enough), [&] {
        if (!std::exchange(begun, true)) {
            timer.expires_after(10 * Loop::idle_timeout);
            timer.async_wait([&](std::error_code) { by = self(); });
        }
        return by != std::thread::id();
    });
    CHECK(by == self());
}

TEST_CASE("loop: a wait ends at its deadline, which is finer than a millisecond, also after waits with a later one")
{
    Running running;
    auto least = Clock::duration::max();
    for (int i = 0; i < 50; ++i) {
        const auto later = in(long_enough), deadline = in(300us);
        running.loop.wait(later, [passes = 0]() mutable { return ++passes == 1; });
        running.loop.wait(deadline, [] { return false; });
        CHECK(Clock::now() >= deadline);
        least = std::min(least, Clock::now() - deadline);
    }
    CHECK(least < 500us);
}

TEST_CASE("loop: tasks keep their order, whoever runs them")
{
    Running running;
    std::promise<void> gate;
    running.leave_to_network_thread(gate.get_future().share());
    std::vector<int> order;
    std::vector<std::thread::id> by;
    const auto task = [&](int number) { return [&, number] { order.push_back(number), by.push_back(self()); }; };
    running.loop.perform(task(1));
    running.loop.perform(task(2));
    CHECK(by.empty());
    gate.set_value();
    running.loop.call(task(3));
    running.loop.perform(task(4));
    running.loop.call([] {});
    CHECK(order == std::vector{1, 2, 3, 4});
    CHECK(by[2] == self());
}

TEST_CASE("loop: the network thread gives the turn back at once, from the middle of its wait")
{
    Running running;
    std::promise<void> open;
    open.set_value();
    running.leave_to_network_thread(open.get_future().share());
    std::thread::id by;
    running.loop.call([&] { by = self(); });
    CHECK(by == self());
}

TEST_CASE("loop: a thread that waits lets another one in, and asks again when it is interrupted")
{
    Running running;
    std::atomic<bool> done = false;
    auto waiting =
        std::async(std::launch::async, [&] { running.loop.wait(in(long_enough), [&] { return done.load(); }); });
    for (int i = 0; i < 100; ++i) {
        std::thread::id by;
        running.loop.call([&] { by = self(); });
        CHECK(by == self());
    }
    done = true;
    running.loop.interrupt();
    CHECK(waiting.wait_for(long_enough / 2) == std::future_status::ready);
}

TEST_CASE(
    "loop: a thread that performs one task after the other does not keep the network thread from running what is ready")
{
    Running running;
    std::atomic<std::thread::id> ran_on{};
    running.loop.call([&] { asio::post(running.loop.context(), [&] { ran_on = self(); }); });
    for (const auto end = in(long_enough); ran_on == std::thread::id() && Clock::now() < end;)
        running.loop.perform([] {});
    CHECK(ran_on != std::thread::id());
    CHECK(ran_on != self());
}

TEST_CASE("loop: what a called task throws is thrown to the caller, and the turn is free again")
{
    Running running;
    CHECK_THROWS_AS(running.loop.call([] { throw std::runtime_error("no"); }), std::runtime_error);
    std::atomic<bool> ran = false;
    running.loop.perform([&] { ran = true; });  // here, or by the network thread if it has the turn just now
    for (const auto end = in(long_enough); !ran && Clock::now() < end;)
        std::this_thread::yield();
    CHECK(ran);
}

TEST_CASE("loop: a call inside a task runs at once, a performed task after it")
{
    Running running;
    std::vector<int> order;
    running.loop.call([&] {
        running.loop.perform([&] { order.push_back(3); });
        running.loop.call([&] { order.push_back(1); });
        order.push_back(2);
    });
    running.loop.call([] {});
    CHECK(order == std::vector{1, 2, 3});
}

TEST_CASE("loop: its end runs what was posted before")
{
    bool ran = false;
    {
        Running running;
        running.loop.post([&] { ran = true; });
    }
    CHECK(ran);
}

}  // namespace hive::event
