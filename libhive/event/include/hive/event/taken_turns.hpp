// Which events of a sender's own numbering an input has begun to process.
#pragma once

#include <hive/event.hpp>

#include <deque>
#include <map>
#include <memory>
#include <string>
#include <utility>

namespace hive::event {

/// By the turns of an output to plain receivers, or of one of its groups, in one run of the sender. Pure logic, for one
/// thread.
class TakenTurns {
public:
    static constexpr std::size_t most_gaps = 4096;  ///< beyond that the lowest turns are forgotten

    explicit TakenTurns(const Share& share) : of_(share.of), epoch_(share.epoch) {}
    [[nodiscard]] bool counts(const Share& share) const { return share.epoch == epoch_ && share.of == of_; }
    /// @return  whether this turn is new. If not, a lossless event is acknowledged no sooner than the one before
    bool take(const Event& event);

private:
    bool add(std::int64_t turn);

    std::string of_;
    std::int64_t epoch_;
    std::map<std::int64_t, std::int64_t> taken_;  ///< the first and last turn of each run of turns without a gap
    std::deque<std::pair<std::int64_t, std::weak_ptr<Acknowledgement>>> owed_;  ///< of turns not acknowledged yet
    std::size_t most_owed_ = 64;                                                ///< then the others are dropped
};

}  // namespace hive::event
