// Events, bodies and loans behind handles.
#pragma once

#include "handles.hpp"

#include <hive/event.hpp>

#include <mutex>
#include <optional>
#include <vector>

namespace hive::c {

class EventObject final : public Object {
public:
    using Handle = hive_event;
    static constexpr const char* name = "hive_event";

    explicit EventObject(Event event) : event_(std::move(event)) {}

    /// Immutable except for its ticket.
    [[nodiscard]] const Event& event() const noexcept { return event_; }
    /// A copy for emitting, without the ticket.
    [[nodiscard]] Event copy() const;
    /// The header as text.
    [[nodiscard]] const std::string& header() const;
    void done();

private:
    Event event_;
    mutable std::mutex mutex_;
    mutable std::optional<std::string> header_;
};

class BodyObject final : public Object {
public:
    using Handle = hive_body;
    static constexpr const char* name = "hive_body";

    explicit BodyObject(Body bytes) : body(std::move(bytes)) {}
    const Body body;
};

class LoanObject final : public Object {
public:
    using Handle = hive_loan;
    static constexpr const char* name = "hive_loan";

    explicit LoanObject(Loan loan) : loan_(std::move(loan)) {}
    /// Throw Errc::invalid_argument once it has become a body.
    [[nodiscard]] std::span<std::byte> bytes() const;
    Body body(std::size_t size);

private:
    mutable std::mutex mutex_;
    std::optional<Loan> loan_;
};

/// The handles of events during a callback.
class Lent {
public:
    explicit Lent(const std::vector<Event>& events);
    explicit Lent(const Event& event);
    ~Lent();
    Lent(const Lent&) = delete;
    Lent& operator=(const Lent&) = delete;

    [[nodiscard]] const hive_event* const* data() const noexcept { return handles_.data(); }
    [[nodiscard]] std::size_t size() const noexcept { return handles_.size(); }

private:
    std::vector<hive_event*> handles_;
};

}  // namespace hive::c
