// Whose turn it is to prepare a set, so that who asks most often does not have every turn.
#pragma once

#include <hive/event/clock.hpp>

#include <string>

namespace hive::service {

/// Who was refused first comes next, and may then try again and again for a while: it has to get hold of other drones
/// at the same time. The network side; pure logic.
class SetTurns {
public:
    /// Longer than an application waits between two attempts (JointSet).
    static constexpr std::chrono::milliseconds kept{150}, lasting{200};

    /// Somebody else's set is held here.
    void refused(const std::string& asker)
    {
        if (next_.empty() && asker != owner_)
            next_ = asker;
    }
    /// Nothing is held: may this one prepare now? @return  empty, or whose turn it is
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
    /// What was held is decided.
    void freed(bool committed, event::Clock::time_point now)
    {
        freed_ = now;
        if (committed)
            until_ = std::min(until_, now);
    }

private:
    std::string owner_;                       ///< has the turn, until
    event::Clock::time_point until_, freed_;  ///< the last time that nothing was held any longer
    std::string next_;                        ///< empty: nobody waits
};

}  // namespace hive::service
