// Keeps the inputs at which this drone's code threw, and the events that crashed its receivers.
#pragma once

#include "reporter.hpp"

#include <hive/event/failure_store.hpp>

namespace hive::service {

/// At most 8 within 8 s, and the same for all receivers together, since a drone that fails at every event would write
/// all of them.
class FailureKeeper {
public:
    FailureKeeper(const protocol::Hello& self, const event::Home& home, const Reporter& reporter)
        : self_(self), home_(home), store_(home), reporter_(reporter)
    {
    }

    /// The user thread. @param inputs  of the callback that threw
    void threw(const Error& error, const std::vector<Event>& inputs);
    /// The network side; see event::Outlet::Hooks. @return a function that writes it on another thread; null: nothing
    /// is kept
    [[nodiscard]] event::EncoderThread::Job receiver_failed(const event::Outlet::Failing& failing);

private:
    void keep(const KeptFailure& failure, const std::string& edge);
    [[nodiscard]] std::string how_it_died(const event::Link& link, Fate how) const;

    const protocol::Hello& self_;
    const event::Home& home_;
    const event::FailureStore store_;
    const Reporter& reporter_;
    event::RateLimits kept_{8, std::chrono::seconds(8)};
};

}  // namespace hive::service
