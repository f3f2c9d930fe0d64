// The encoder thread: jobs in order, and an end that waits for one of them at most.
#include <hive/event/encoder_thread.hpp>

#include <doctest/doctest.h>

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
        thread.push([&, i] {
            order.push_back(i);
            threads.push_back(std::this_thread::get_id());
        });
    thread.push([&] { last.set_value(); });
    last.get_future().wait();
    REQUIRE(order.size() == 100);
    for (int i = 0; i < 100; ++i)
        CHECK(order[static_cast<std::size_t>(i)] == i);
    CHECK(threads.front() == threads.back());
    CHECK(threads.front() != std::this_thread::get_id());
}

TEST_CASE("encoder thread: at the end the job under way is finished and the others are dropped, with what they hold")
{
    EncoderThread thread;
    std::promise<void> begun, go_on;
    bool finished = false, second = false;
    const auto held = std::make_shared<int>(0);
    thread.push([&, waiting = go_on.get_future().share()] {
        begun.set_value();
        waiting.wait();
        finished = true;
    });
    thread.push([&second, held] { second = true; });
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
    thread.push([&second] { second = true; });
    thread.end();
    CHECK_FALSE(second);
}

}  // namespace hive::event
