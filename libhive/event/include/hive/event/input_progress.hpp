// What one input was given at its place and has dealt with, and what its sender must be told of that (SPEC.md, 5.2).
#pragma once

#include <hive/protocol/messages.hpp>
#include <hive/transfer.hpp>

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace hive::event {

/// The receiver's end of a Credit. All deliveries are counted from the first at the place on; the numbering goes on
/// when the input registers again there. Pure logic.
class InputProgress {
public:
    /// Registered: goes on behind what is in hand if the sender does so at the same place.
    /// @param epoch  of the registration
    /// @param held   what it was when it registered, which the sender knows
    /// @return       false: the numbering starts again behind `taken`, and what was in hand is forgotten
    bool begin(std::int64_t epoch, const ConnectionOptions& options, std::int64_t place, std::int64_t taken,
               std::int64_t held);
    /// The sender was started again, and knows nothing of the place.
    void lose_place() { place_ = 0; }
    [[nodiscard]] std::int64_t place() const { return place_; }

    /// May the sender give one more?
    [[nodiscard]] bool allows(bool lossless) const;
    /// @param turn  of the group; 0: it is none's
    /// @return      its number
    std::int64_t receive(bool lossless, std::int64_t turn);
    /// Of the numbering: heard() ignores deliveries of an earlier one.
    [[nodiscard]] std::int64_t generation() const { return generation_; }
    /// A delivery was processed, or is done with. @param back  and is handed back if another member can have it
    void heard(std::int64_t generation, std::int64_t number, bool worked, bool done, bool back);

    /// What must be told now, if anything. @param may_ask  for more
    std::optional<protocol::Request> news(bool may_ask);
    /// What was dealt with and not told; nothing more will be.
    std::optional<protocol::Request> last_news();
    /// What was told last once more, which asks for nothing.
    [[nodiscard]] const protocol::Request& told() const { return told_; }
    /// Acknowledges all that is in hand, whatever becomes of it.
    protocol::Request acknowledge_all();
    /// Acknowledges nothing of what is in hand.
    void forget();

    [[nodiscard]] std::int64_t arrived() const { return done_ + static_cast<std::int64_t>(in_hand_.size()); }
    /// Deliveries that count against the window when it registers, forgotten ones too: those that are not
    /// processed; if it may not ask for more, those that are not acknowledged.
    [[nodiscard]] std::int64_t held(bool may_ask) const
    {
        return may_ask ? unprocessed_before_ + arrived() - finished_ : owed_before_ + arrived() - done_;
    }
    [[nodiscard]] bool empty() const { return in_hand_.empty(); }
    [[nodiscard]] bool all_worked() const { return worked_ == arrived(); }
    /// Is anything left to process, of earlier numberings, too?
    [[nodiscard]] bool works() const { return !all_worked() || unprocessed_before_ > 0; }
    [[nodiscard]] bool lossless_in_hand() const;
    /// Was something processed that is not acknowledged yet?
    [[nodiscard]] bool owes() const;
    /// The turns in hand.
    [[nodiscard]] std::vector<std::int64_t> turns() const;

private:
    struct Delivery {
        std::int64_t turn = 0;
        bool lossless = false, worked = false, done = false;
    };
    [[nodiscard]] Delivery* delivery(std::int64_t number);
    [[nodiscard]] std::int64_t allowed(std::int64_t ask, std::int64_t worked) const;
    [[nodiscard]] bool urgent(std::int64_t worked, bool more) const;
    protocol::Request tell(std::int64_t ask, std::int64_t worked);

    ConnectionOptions options_;
    std::int64_t place_ = 0, generation_ = 0;
    std::int64_t done_ = 0;                                  ///< dealt with, from the first on
    std::int64_t worked_ = 0;                                ///< processed, from the first on
    std::int64_t finished_ = 0;                              ///< processed, in any order
    std::deque<Delivery> in_hand_;                           ///< those behind done_
    std::int64_t unprocessed_before_ = 0, owed_before_ = 0;  ///< of earlier numberings, not processed, or not done with
    std::vector<std::int64_t> back_;
    protocol::Request told_;    ///< last
    std::int64_t allowed_ = 0;  ///< up to this number the sender may give; live events of a stream always
    bool lossless_ = false;     ///< the last event was
};

}  // namespace hive::event
