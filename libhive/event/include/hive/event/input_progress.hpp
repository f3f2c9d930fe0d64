// The deliveries that one input received at its place and has finished, and what to report to its sender (SPEC.md,
// 5.2).
#pragma once

#include <hive/protocol/messages.hpp>
#include <hive/transfer.hpp>

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace hive::event {

/// The receiver's end of a Credit. All deliveries are counted from the first one at the place; the numbering continues
/// when the input registers there again. Pure logic.
class InputProgress {
public:
    /// Registered: continues after the deliveries in progress if the sender does so at the same place.
    /// @param epoch  of the registration
    /// @param held  the value sent in the registration
    /// @return false: the numbering restarts after `taken`, and the deliveries in progress are forgotten
    bool begin(std::int64_t epoch, const ConnectionOptions& options, std::int64_t place, std::int64_t taken,
               std::int64_t held);
    /// The sender was restarted, and does not know the place.
    void lose_place() { place_ = 0; }
    /// Where it may resume; 0: nowhere, also if its request then would return too many deliveries.
    [[nodiscard]] std::int64_t place() const;

    /// May the sender send one more?
    [[nodiscard]] bool allows(bool lossless) const;
    /// @param turn  of the group; 0: no group
    /// @return      its number
    std::int64_t receive(bool lossless, std::int64_t turn);
    /// Identifies the numbering: heard() ignores deliveries of an earlier one.
    [[nodiscard]] std::int64_t generation() const { return generation_; }
    /// A delivery was processed, or is finished. @param back  return it if another member can get it
    void heard(std::int64_t generation, std::int64_t number, bool worked, bool done, bool back);

    /// The request that must be sent now, if any. @param may_ask  for more events @param late  nothing may wait longer
    /// @param held_before  unprocessed deliveries of earlier inputs with the same ends
    std::optional<protocol::Request> news(bool may_ask, bool late = false, std::int64_t held_before = 0);
    /// Has a stream something to report that may wait a little? A report of each live event would double its packets.
    [[nodiscard]] bool has_late_news() const;
    /// Processed and finished deliveries that were not reported; the last report.
    std::optional<protocol::Request> last_news();
    /// Repeats the last request, which requests nothing new.
    [[nodiscard]] const protocol::Request& told() const { return told_; }
    /// Acknowledges all deliveries in progress, whatever their outcome.
    protocol::Request acknowledge_all();
    /// Acknowledges none of the deliveries in progress.
    void forget();

    [[nodiscard]] std::int64_t arrived() const { return done_ + static_cast<std::int64_t>(in_hand_.size()); }
    /// Deliveries that count against the window when it registers, including forgotten ones: unprocessed ones; if it
    /// may not request more, unacknowledged ones.
    [[nodiscard]] std::int64_t held(bool may_ask) const
    {
        return may_ask ? unprocessed_before_ + arrived() - finished_ : owed_before_ + arrived() - done_;
    }
    [[nodiscard]] bool empty() const { return in_hand_.empty(); }
    [[nodiscard]] bool all_worked() const { return worked_ == arrived(); }
    /// Is anything left to process, even of earlier numberings?
    [[nodiscard]] bool works() const { return !all_worked() || unprocessed_before_ > 0; }
    [[nodiscard]] bool lossless_in_hand() const;
    /// Is a processed delivery not acknowledged yet?
    [[nodiscard]] bool owes() const;
    /// The turns in progress.
    [[nodiscard]] std::vector<std::int64_t> turns() const;

private:
    struct Delivery {
        std::int64_t turn = 0;
        bool lossless = false, worked = false, done = false;
    };
    [[nodiscard]] Delivery* delivery(std::int64_t number);
    [[nodiscard]] std::int64_t allowed(std::int64_t ask, std::int64_t worked) const;
    [[nodiscard]] bool urgent(std::int64_t worked, bool more, bool waits) const;
    protocol::Request tell(std::int64_t ask, std::int64_t worked);

    ConnectionOptions options_;
    std::int64_t place_ = 0, generation_ = 0;
    std::int64_t done_ = 0;                                  ///< finished, from the first on
    std::int64_t worked_ = 0;                                ///< processed, from the first on
    std::int64_t finished_ = 0;                              ///< processed, in any order
    std::deque<Delivery> in_hand_;                           ///< those behind done_
    std::int64_t unprocessed_before_ = 0, owed_before_ = 0;  ///< of earlier numberings, not processed, or not finished
    struct Returned {
        std::int64_t number;
        std::int64_t until;  ///< a delivery beyond this one shows that the sender got the request
    };
    std::vector<std::int64_t> back_;  ///< to be returned
    std::deque<Returned> returned_;   ///< in a request that may have been lost
    protocol::Request told_;          ///< last
    std::int64_t allowed_ = 0;        ///< the sender may send up to this number; live events of a stream always
    std::int64_t prompt_until_ = 0;   ///< a stream reports at once until the last lossless delivery is acknowledged
};

}  // namespace hive::event
