// The events of the last seconds, in this process's own memory.
#pragma once

#include <hive/event.hpp>

#include <chrono>
#include <deque>
#include <string>
#include <utility>

namespace record {

class LastSeconds {
public:
    static constexpr std::size_t max_bytes = 256'000'000;

    /// Acknowledges the event at once, and copies its body out of shared memory.
    void keep(hive::Event event)
    {
        event.ticket = {};
        if (event.body.foreign())
            event.body = hive::Body(std::string(reinterpret_cast<const char*>(event.body.data()), event.body.size()));
        bytes_ += event.body.size();
        events_.push_back(std::move(event));
        while (bytes_ > max_bytes) {
            full_ = true;
            forget_oldest();
        }
    }
    void forget_before(std::chrono::steady_clock::time_point time)
    {
        while (!events_.empty() && events_.front().received < time) {
            full_ = false;
            forget_oldest();
        }
    }
    [[nodiscard]] std::deque<hive::Event> take()
    {
        bytes_ = 0;
        full_ = false;
        return std::exchange(events_, {});
    }
    /// Were events dropped earlier because of the limit of bytes?
    [[nodiscard]] bool full() const { return full_; }

private:
    void forget_oldest()
    {
        bytes_ -= events_.front().body.size();
        events_.pop_front();
    }

    std::deque<hive::Event> events_;
    std::size_t bytes_ = 0;
    bool full_ = false;
};

}  // namespace record
