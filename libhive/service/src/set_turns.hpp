// Gives askers turns to prepare a set, so that the most frequent one does not get every turn.
#pragma once

#include <hive/event/clock.hpp>

#include <string>

namespace hive::service {

/// The asker that was refused first is next, and may then retry for some time, since it needs other drones at the same
/// time. The network side; pure logic.
class SetTurns {
public:
    /// Longer than an application's delay between two attempts (JointSet).
    static constexpr std::chrono::milliseconds kept{150}, lasting{200};

    /// Another asker's set is held here.
    void refused(const std::string& asker)
    {
        if (next_.empty() && asker != owner_)
            next_ = asker;
    }
    /// Nothing is held: may this asker prepare now? @return empty, or the asker that has the turn
    [[nodiscard]] std::string taken_by(const std::string& asker, event::Clock::time_point now)
    {
        if (now < until_) {
            refused(asker);
            return asker == owner_ ? "" : owner_;
        }
        if (!next_.empty() && next_ != asker && now < std::max(until_, freed_) + kept)
            return next_;
        owner_ = asker;
        until_ = next_ == asker ? now + lasting : now;
        next_.clear();
        return "";
    }
    /// The held set is decided.
    void freed(bool committed, event::Clock::time_point now)
    {
        freed_ = now;
        if (committed)
            until_ = std::min(until_, now);
    }

private:
    std::string owner_;                       ///< has the turn, until
    event::Clock::time_point until_, freed_;  ///< when the last held set was released
    std::string next_;                        ///< empty: no asker waits
};

}  // namespace hive::service
