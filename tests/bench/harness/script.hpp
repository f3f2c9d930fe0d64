// What a publisher has to do, frame by frame: find its receivers, warm up, the measured part, the end.
#pragma once

#include "board.hpp"
#include "run.hpp"

#include <optional>

namespace hive::bench {

/// For the publisher's thread. Call due() until it gives nothing; when its time has come, produce next().
class Script {
public:
    /// @param credit  measured frames under way at most; 0: the transport holds the publisher back itself
    Script(const Run& run, int credit, Board& board);

    /// When the next frame is due; nothing: all is done. Waits while the credit is used up, and for the last measured
    /// frame. Throws std::runtime_error when receivers do not come.
    std::optional<Nanoseconds> due();
    /// The frame that is due, stamped with the present time.
    Frame next();

private:
    enum class Phase { probing, warming, measuring, ending, done };
    void advance();
    void begin(Phase phase, Nanoseconds pause);
    [[nodiscard]] bool measured_enough() const;
    bool wait_for_credit(std::uint64_t credit, Nanoseconds timeout);
    void finish_measuring();

    const Run& run_;
    std::uint64_t credit_;
    Board& board_;
    Cameras cameras_;
    Phase phase_ = Phase::probing;
    Nanoseconds next_, give_up_;
    std::uint64_t sequence_ = 0;  ///< of the next frame
    std::uint64_t in_phase_ = 0;  ///< frames sent in this phase
    Nanoseconds measuring_since_ = 0;
    Usage usage_;
};

}  // namespace hive::bench
