// The implementation of tickets: notifies the input that an event was processed, and may be acknowledged.
#pragma once

#include <hive/event.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace hive::event {

class Intake;
class Loop;

/// The outcome of an event at an input.
enum class Ending {
    processed,
    abandoned,  ///< the user's code threw
    duplicate,  ///< it came before, or another answer to the same work did
    discarded,  ///< not started
    dropped,    ///< the queue was full
    unmatched,  ///< without a partner
};
inline constexpr std::size_t endings = 6;

/// One delivery to an input, which is acknowledged when this object is destroyed. The tickets of the event share it,
/// and report early what they can. Any thread.
class Acknowledgement {
public:
    /// Acknowledges no delivery itself; keeps others back.
    Acknowledgement() = default;
    /// @param generation  of the numbering
    Acknowledgement(std::weak_ptr<Loop> loop, std::weak_ptr<Intake> intake, std::int64_t generation,
                    std::int64_t number);
    Acknowledgement(const Acknowledgement&) = delete;
    Acknowledgement& operator=(const Acknowledgement&) = delete;
    ~Acknowledgement();

    /// Sets the outcome of the event; once, by its only user.
    void conclude(Ending ending);
    /// Makes the other acknowledgement wait for this one: it is for the same work, which may still be lost.
    void hold(std::shared_ptr<Acknowledgement> other) { held_.push_back(std::move(other)); }
    [[nodiscard]] std::shared_ptr<Intake> intake() const { return intake_.lock(); }
    /// Does a copy of the event count as being processed?
    [[nodiscard]] bool processing() const { return processing_ > 0; }

private:
    friend class hive::Ticket;

    void begin() { ++processing_; }
    /// @param last  this object is being destroyed
    void stop(bool last);
    void tell(bool processed, bool done, std::optional<Ending> ending) const;
    std::optional<Ending> news();

    std::weak_ptr<Loop> loop_;
    std::weak_ptr<Intake> intake_;
    std::int64_t generation_ = 0, number_ = 0;
    std::atomic<int> processing_ = 0;              ///< number of tickets in processing
    bool processed_ = false, tells_both_ = false;  ///< report "processed" together with the end
    bool concluded_ = false, told_ = false;
    Ending ending_ = Ending::processed;
    std::vector<std::shared_ptr<Acknowledgement>> held_;
};

/// Counts the outcome of the event; does nothing without a ticket.
void conclude(const Event& event, Ending ending);
/// A predicate: did an event arrive over this connection, which must outlive the predicate?
std::function<bool(const Event&)> came_over(const Intake& intake);
/// Did it arrive over a connection to a group, so that another member can get it? Network side.
bool came_to_member(const Event& event);
/// The ticket for a set's results: no event of the set is acknowledged sooner.
Ticket causes(const std::vector<Event>& set);

}  // namespace hive::event
