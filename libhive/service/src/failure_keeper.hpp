// Keeps what this drone's code threw at, and what its receivers died of.
#pragma once

#include "reporter.hpp"

#include <hive/event/failure_store.hpp>

namespace hive::service {

/// At most 8 within 8 s, and of all receivers together as many: who fails at every event would write all of them.
class FailureKeeper {
public:
    FailureKeeper(const protocol::Hello& self, const event::Home& home, const Reporter& reporter)
        : self_(self), home_(home), store_(home), reporter_(reporter)
    {
    }

    /// The user thread. @param inputs  of the callback that threw
    void threw(const Error& error, const std::vector<Event>& inputs);
    /// The network side; see event::Outlet::Hooks. @return  what writes it, to be done aside; null: nothing is kept
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
