// The log of a drone, and its exceptions as events.
#pragma once

#include "status_board.hpp"

#include <hive/event/rate_limits.hpp>
#include <hive/event/module.hpp>

namespace hive::service {

/// Any thread, once it is attached.
class Reporter {
public:
    /// @param sink  gets the lines of the log; empty: the log of the program
    Reporter(const protocol::Hello& self, StatusBoard& board, Log sink)
        : self_(self), board_(board), sink_(std::move(sink))
    {
    }

    /// Before this, exceptions reach only the log and the board.
    void attach(event::Module& module);

    void log(LogLevel level, const std::string& text) const;
    /// An exception goes to subscribed applications, to the status board and to the log.
    /// @param cause  the event in progress, or null
    void report(const Error& error, const Event* cause = nullptr);

    /// "face failed at 3 events, at last: the image is empty", counting lossless ones; empty: none. See
    /// event::Outlet::Hooks.
    [[nodiscard]] std::string failures(const Event* newest) const;

private:
    struct Failures {
        std::int64_t epoch = 0, count = 0;
    };
    void count(const Event& exception);
    [[nodiscard]] Event exception_event(const Error& error, const Event* cause) const;

    const protocol::Hello& self_;
    StatusBoard& board_;
    const Log sink_;
    event::Module* module_ = nullptr;
    event::Outlet* exceptions_ = nullptr;
    event::RateLimits lines_{10, std::chrono::seconds(1)};  ///< of exceptions, by their sender
    std::map<std::string, Failures> failures_;              ///< by source; the network side
    std::string last_failure_;                              ///< its text
    std::atomic<std::int64_t> given_ = 0;                   ///< turns of exceptions of lossless events
};

}  // namespace hive::service
