// What an event carries while it is worked on: it tells its input when the next one may be asked for, and when it was
// dealt with and how.
#pragma once

#include <hive/event.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace hive::event {

class Door;
class Intake;

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

/// One delivery to an input: which one, and the way back to tell of it. Any thread.
struct Delivered {
    std::shared_ptr<Door> door;
    std::weak_ptr<Intake> intake;
    std::int64_t generation = 0;  ///< of the numbering
    std::int64_t number = 0;

    /// @param worked  the next event may be asked for
    /// @param done    the event may be acknowledged
    /// @param ending  how it ended, for who counts; nothing: not now
    void tell(bool worked, bool done, std::optional<Ending> ending) const;
};

/// Alive as long as the event must not be acknowledged. It tells as much at once as it can.
class Custody {
public:
    /// @param credit  its end also means that the event was worked on
    Custody(Delivered delivered, bool credit) : delivered_(std::move(delivered)), credit_(credit) {}
    Custody(const Custody&) = delete;
    Custody& operator=(const Custody&) = delete;
    ~Custody() { delivered_.tell(credit_, true, told_ ? std::nullopt : std::optional(ending_)); }

    void conclude(Ending ending) const;
    void give_back_credit() const;
    [[nodiscard]] std::shared_ptr<Intake> intake() const { return delivered_.intake.lock(); }
    /// Holds this one as long: it is for the same work, and whoever has that may still die with it.
    void hold(std::shared_ptr<const void> other) const { held_.push_back(std::move(other)); }
    /// The event was worked on. @param last  and this custody ends now
    void worked(bool last) const;

private:
    [[nodiscard]] std::optional<Ending> news() const;

    Delivered delivered_;
    mutable bool credit_;  ///< is still to be told
    mutable bool worked_ = false, concluded_ = false, told_ = false;
    mutable Ending ending_ = Ending::processed;
    mutable std::vector<std::shared_ptr<const void>> held_;
};

/// Alive as long as an event is worked on that somebody else may have in custody for longer.
class WorkReceipt {
public:
    explicit WorkReceipt(std::shared_ptr<const Custody> custody) : custody_(std::move(custody)) {}
    WorkReceipt(const WorkReceipt&) = delete;
    WorkReceipt& operator=(const WorkReceipt&) = delete;
    ~WorkReceipt() { custody_->worked(custody_.use_count() == 1); }

private:
    std::shared_ptr<const Custody> custody_;
};

/// Gives an event that has arrived its receipt and custody.
void give_receipt(Event& event, Delivered delivered);
/// Says how an event ended, which counts from now on; once. Nothing happens to an event without custody. For its only
/// user.
void conclude(const Event& event, Ending ending);
/// Did it arrive over this connection?
bool came_over(const Event& event, const Intake& intake);
/// Did it arrive over a connection to a group, so that another member can have it? Network side.
bool came_to_member(const Event& event);
/// The next event may be asked for, although this one has to wait.
void give_back_credit(Event& event);
/// The custody of all the events of a set.
std::shared_ptr<const void> custody_of(const std::vector<Event>& set);

}  // namespace hive::event
