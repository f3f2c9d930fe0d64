// What stands behind the ticket of an event: how its input hears that the event was processed, and may be acknowledged.
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

/// How an input came to be done with an event.
enum class Ending {
    processed,
    abandoned,  ///< the user's code threw
    duplicate,  ///< a second answer
    discarded,  ///< not begun
    dropped,    ///< the queue was full
    unmatched,  ///< found no partner
};
inline constexpr std::size_t endings = 6;

/// One delivery to an input, which is not acknowledged before this ends. The tickets of the event share it, and tell
/// what they can at once. Any thread.
class Acknowledgement {
public:
    /// Of nothing itself; for what it holds.
    Acknowledgement() = default;
    /// @param generation  of the numbering
    Acknowledgement(std::weak_ptr<Loop> loop, std::weak_ptr<Intake> intake, std::int64_t generation,
                    std::int64_t number);
    Acknowledgement(const Acknowledgement&) = delete;
    Acknowledgement& operator=(const Acknowledgement&) = delete;
    ~Acknowledgement();

    /// How the event ended, which counts from now on; once, by its only user.
    void conclude(Ending ending);
    /// That one is given no sooner than this one: it is for the same work, which may still be lost.
    void hold(std::shared_ptr<Acknowledgement> other) { held_.push_back(std::move(other)); }
    [[nodiscard]] std::shared_ptr<Intake> intake() const { return intake_.lock(); }
    /// Does a copy of the event say so?
    [[nodiscard]] bool processing() const { return processing_ > 0; }

private:
    friend class hive::Ticket;

    void begin() { ++processing_; }
    /// @param last  and this ends now
    void stop(bool last);
    void tell(bool processed, bool done, std::optional<Ending> ending) const;
    std::optional<Ending> news();

    std::weak_ptr<Loop> loop_;
    std::weak_ptr<Intake> intake_;
    std::int64_t generation_ = 0, number_ = 0;
    std::atomic<int> processing_ = 0;              ///< how many tickets say so
    bool processed_ = false, tells_both_ = false;  ///< with its end, that it was processed too
    bool concluded_ = false, told_ = false;
    Ending ending_ = Ending::processed;
    std::vector<std::shared_ptr<Acknowledgement>> held_;
};

/// Counts how the event ended; without a ticket it does nothing.
void conclude(const Event& event, Ending ending);
/// Says of an event whether it arrived over this connection, which lasts as long.
std::function<bool(const Event&)> came_over(const Intake& intake);
/// Did it arrive over a connection to a group, so that another member can have it? Network side.
bool came_to_member(const Event& event);
/// For what is made of a set: no event of it is acknowledged sooner.
Ticket causes(const std::vector<Event>& set);

}  // namespace hive::event
