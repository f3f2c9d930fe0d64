// The encoder thread: jobs in order, and an end that waits for one of them at most.
#include <hive/event/encoder_thread.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <future>
#include <memory>
#include <vector>

namespace hive::event {

TEST_CASE("encoder thread: jobs run in order on one thread, which is not the caller's")
{
    EncoderThread thread;
    std::vector<std::thread::id> threads;
    std::vector<int> order;
    std::promise<void> last;
    for (int i = 0; i < 100; ++i)
        thread.push("peer", [&, i] {
            order.push_back(i);
            threads.push_back(std::this_thread::get_id());
        });
    thread.push("peer", [&] { last.set_value(); });
    last.get_future().wait();
    REQUIRE(order.size() == 100);
    for (int i = 0; i < 100; ++i)
        CHECK(order[static_cast<std::size_t>(i)] == i);
    CHECK(threads.front() == threads.back());
    CHECK(threads.front() != std::this_thread::get_id());
}

TEST_CASE("encoder thread: it knows how long it has been working, also on the job under way")
{
    using namespace std::chrono_literals;
    EncoderThread thread;
    CHECK(thread.worked() == 0s);
    std::promise<void> begun, go_on, done;
    thread.push("peer", [&] {
        begun.set_value();
        go_on.get_future().wait();
    });
    thread.push("peer", [&] { done.set_value(); });
    begun.get_future().wait();
    std::this_thread::sleep_for(20ms);
    CHECK(thread.worked() >= 20ms);
    go_on.set_value();
    done.get_future().wait();
    thread.end();
    const auto worked = thread.worked();
    CHECK(worked >= 20ms);
    std::this_thread::sleep_for(5ms);
    CHECK(thread.worked() == worked);
}

TEST_CASE("encoder thread: a peer with much to do and one with little have their jobs done in turn")
{
    EncoderThread thread;
    std::promise<void> go_on, last;
    std::string order, when_little_was_done;
    thread.push("much", [waiting = go_on.get_future().share()] { waiting.wait(); });
    for (int i = 0; i < 60; ++i)
        thread.push("much", [&] { order += 'm'; });
    for (int i = 0; i < 3; ++i)
        thread.push("little", [&] { order += 'l'; });
    thread.push("little", [&] {
        when_little_was_done = order;
        last.set_value();
    });
    go_on.set_value();
    last.get_future().wait();
    thread.end();
    CHECK(std::ranges::count(when_little_was_done, 'l') == 3);
    CHECK(std::ranges::count(when_little_was_done, 'm') <= 5);  // one in between each, and one that was under way
}

TEST_CASE("encoder thread: at the end the job under way is finished and the others are dropped, with what they hold")
{
    EncoderThread thread;
    std::promise<void> begun, go_on;
    bool finished = false, second = false;
    const auto held = std::make_shared<int>(0);
    thread.push("peer", [&, waiting = go_on.get_future().share()] {
        begun.set_value();
        waiting.wait();
        finished = true;
    });
    thread.push("peer", [&second, held] { second = true; });
    begun.get_future().wait();
    // The end drops the second job before it waits for the first, which goes on only then.
    std::thread ender([&] { thread.end(); });
    while (held.use_count() > 1)
        std::this_thread::yield();
    CHECK_FALSE(finished);
    go_on.set_value();
    ender.join();
    CHECK(finished);
    CHECK_FALSE(second);
    thread.push("peer", [&second] { second = true; });
    thread.end();
    CHECK_FALSE(second);
}

}  // namespace hive::event
