// Asks the senders that have sent their end whether it still holds (SPEC.md, section 5.6).
#pragma once

#include <hive/event/clock.hpp>
#include <hive/platform/timer.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace hive::event {

class Intake;

/// Network side. One round of questions runs at a time, and calls meanwhile wait for the next round: an answer is valid
/// only for calls made before it. The senders get the longest remaining time of the callers in the round, so that
/// questions that go in a circle end.
class EndCheck {
public:
    using Then = std::function<void()>;
    using Intakes = std::vector<std::shared_ptr<Intake>>;

    /// @param intakes  the intakes whose senders are asked
    EndCheck(asio::io_context& context, const Intakes& intakes) : intakes_(intakes), timer_(context) {}
    /// Calls back when each sender has answered or is gone; at once if there is none.
    /// @param within  a sender without an answer by then is ignored: it is of an earlier version, or drones wait for
    /// each other
    void begin(std::chrono::milliseconds within, Then then);
    /// Checks whether all senders have answered; call it when one may have.
    void look();
    void stop();

private:
    struct Question {
        Clock::time_point until;
        Then then;
    };
    void ask();

    const Intakes& intakes_;
    platform::Timer timer_;
    int round_ = 0;  ///< a timer that was cancelled may still run
    Intakes asked_;
    std::vector<Question> asking_, waiting_;
};

}  // namespace hive::event
