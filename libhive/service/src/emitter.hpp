// What a drone emits: identities, bodies in shared memory, the way to the network side.
#pragma once

#include "declaration.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/module.hpp>

#include <atomic>
#include <list>
#include <optional>

namespace hive::service {

/// What a source could not give, which has a number all the same.
class CaptureFailed : public Error {
public:
    CaptureFailed(const Error& error, Identity identity) : Error(error) { lost_.identity = std::move(identity); }
    [[nodiscard]] const Event& lost() const noexcept { return lost_; }

private:
    Event lost_;
};

/// The user thread, but for loan().
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
    /// Until finish(), what is emitted inherits from this set.
    void begin(const Set& set);
    void finish() { set_ = nullptr; }

    // --- for Output ---
    /// Any thread, once attached.
    [[nodiscard]] Loan loan(std::size_t bytes) const;
    [[nodiscard]] bool wanted(std::size_t output) const;
    /// Is a body to be made for what is emitted now? Also when it is lossless and nobody receives anything of this
    /// drone yet: then it waits for whoever comes first, at whichever output.
    [[nodiscard]] bool needs_body(std::size_t output) const;
    [[nodiscard]] bool received(std::size_t output) const;
    [[nodiscard]] bool asked(std::size_t output) const;
    [[nodiscard]] bool backlogged(std::size_t output) const;
    /// Its number is taken when the event is sent.
    [[nodiscard]] Identity fresh_identity(std::size_t output, std::int64_t captured_us, bool lossless) const;
    /// @param begun  empty: inherited from the present set, or a new one
    /// @param body  gives nothing when nobody wants it
    void emit(std::size_t output, std::optional<Identity> begun, Json header,
              const std::function<std::optional<Body>()>& body, std::string type);
    /// Takes the number of an event that cannot be made, and throws CaptureFailed.
    [[noreturn]] void fail(std::size_t output, std::int64_t captured_us, bool lossless, const Error& error);
    void repeat(std::size_t output, Event event);
    /// Nothing more will come; what is captured after all begins a new epoch.
    void end(std::size_t output, const std::string& text);
    /// What is captured from now on is of another source.
    void begin_source(std::size_t output);
    /// All outputs end, if it is `still` so when the network side comes to it.
    void end_all(const std::string& text, const std::function<bool()>& still);

private:
    struct Slot {         ///< one output
        Encoder encoder;  ///< until the outlet has it
        event::Outlet* outlet = nullptr;
        std::int64_t epoch = 0;            ///< of the source
        std::int64_t sequence = 0;         ///< of the last identity that was begun
        std::int64_t given = 0;            ///< turns of lossless events
        int part = 0;                      ///< events emitted for the present set
        std::atomic<int> handed_over = 0;  ///< tasks that the network side has not done yet
    };
    void inherit(Event& event, Slot& slot) const;
    [[nodiscard]] const Port& port_to_emit(std::size_t output, const Json& header) const;
    void send(std::size_t output, Event event, bool complete);
    void perform(Slot& slot, std::function<void(event::Outlet&)> task);
    void await_room(Slot& slot);

    const protocol::Hello& self_;
    Interface& interface_;
    event::Mailbox& mailbox_;
    event::Module* module_ = nullptr;
    std::list<Slot> slots_;
    std::vector<Slot*> outputs_;  ///< the slots, by number
    const Set* set_ = nullptr;    ///< what is being worked on
    event::Clock::time_point begun_{};
};

}  // namespace hive::service
