// Emits events: gives them identities, puts bodies into shared memory, and passes them to the network side.
#pragma once

#include "declaration.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/module.hpp>

#include <atomic>
#include <list>
#include <optional>

namespace hive::service {

/// A source item that could not be sent, but still has a sequence number.
class CaptureFailed : public Error {
public:
    CaptureFailed(const Error& error, Identity identity) : Error(error) { lost_.identity = std::move(identity); }
    [[nodiscard]] const Event& lost() const noexcept { return lost_; }

private:
    Event lost_;
};

/// The user thread, except loan().
class Emitter {
public:
    Emitter(const protocol::Hello& self, Interface& interface, event::Mailbox& mailbox)
        : self_(self), interface_(interface), mailbox_(mailbox)
    {
    }

    // --- before run() ---
    std::size_t add_output(Port port, Encoder encoder);
    void attach(event::Module& module);

    // --- around a callback ---
    /// Until finish(), emitted events inherit from this set.
    void begin(const Set& set);
    void finish() { set_ = nullptr; }

    // --- for Output ---
    /// Any thread, once attached.
    [[nodiscard]] Loan loan(std::size_t bytes) const;
    [[nodiscard]] bool wanted(std::size_t output) const;
    /// Must a body be made for an event emitted now? True also for a lossless event as long as this drone has no
    /// receiver: the event then waits for the first receiver at any output.
    [[nodiscard]] bool needs_body(std::size_t output) const;
    [[nodiscard]] bool received(std::size_t output) const;
    [[nodiscard]] bool asked(std::size_t output) const;
    [[nodiscard]] bool backlogged(std::size_t output) const;
    /// The sequence number is taken when the event is sent.
    [[nodiscard]] Identity fresh_identity(std::size_t output, std::int64_t captured_us, bool lossless) const;
    /// @param begun  empty: inherited from the current set, or a new one
    /// @param body  returns nothing if no receiver wants it
    void emit(std::size_t output, std::optional<Identity> begun, Json header,
              const std::function<std::optional<Body>()>& body, std::string type);
    /// Takes a sequence number for an event that cannot be made, and throws CaptureFailed.
    [[noreturn]] void fail(std::size_t output, std::int64_t captured_us, bool lossless, const Error& error);
    void repeat(std::size_t output, Event event);
    /// Nothing more will come; a later capture starts a new epoch.
    void end(std::size_t output, const std::string& text);
    /// Later captures are of another source.
    void begin_source(std::size_t output);
    /// Ends all outputs, if `still` is true when the network side executes it.
    void end_all(const std::string& text, const std::function<bool()>& still);

private:
    struct Slot {         ///< one output
        Encoder encoder;  ///< until the outlet has it
        event::Outlet* outlet = nullptr;
        std::int64_t epoch = 0;            ///< of the source
        std::int64_t sequence = 0;         ///< of the last new identity
        std::int64_t given = 0;            ///< turns of lossless events
        int part = 0;                      ///< events emitted for the current set
        std::atomic<int> handed_over = 0;  ///< pending tasks of the network side
    };
    void inherit(Event& event, Slot& slot) const;
    [[nodiscard]] const Port& port_to_emit(std::size_t output, const Json& header) const;
    void send(std::size_t output, Event&& event, bool complete);
    void perform(Slot& slot, std::function<void(event::Outlet&)> task);
    void await_room(Slot& slot);

    const protocol::Hello& self_;
    Interface& interface_;
    event::Mailbox& mailbox_;
    event::Module* module_ = nullptr;
    std::list<Slot> slots_;
    std::vector<Slot*> outputs_;  ///< the slots, by number
    const Set* set_ = nullptr;    ///< the input of the running callback
    event::Clock::time_point begun_{};
};

}  // namespace hive::service
