// Checks that events are one sequence of images: one source, in order, with a time for each.
#pragma once

#include <hive/error.hpp>
#include <hive/event.hpp>

#include <chrono>
#include <optional>
#include <string>

namespace frame_order {

class Order {
public:
    /// Does this frame continue the last one? False for the first of a source or of a restarted one.
    /// @throws hive::Error  refused: it comes after a later image of its source. If the same drone sent both, it does
    ///                      not count; otherwise the next image may go on from it: no drone may number for another.
    ///                      Refused as well: its source was left for another one, which still sends; it does not count
    bool continues(const hive::Event& event)
    {
        if (left_ && left_->is_of(event) && event.received - last_->received < still_sends)
            throw hive::Error(hive::Errc::refused,
                              "frames of " + left_->source + " and " + last_->source
                                  + " alternate, but tracks need a single source",
                              "start one drone per source, and connect only that source to it");
        const bool same = last_ && last_->is_of(event);
        const bool late = same && event.identity.sequence <= last_->sequence;
        const auto before = last_;
        if (last_ && !same)
            left_ = last_;
        if (!late || last_->sender != event.sender)
            last_ = Last{event.sender, event.identity.source, event.identity.epoch, event.identity.sequence,
                         event.received};
        if (late)
            throw hive::Error(hive::Errc::refused, "frame " + std::to_string(event.identity.sequence) + " of "
                                                       + before->source + " comes after frame "
                                                       + std::to_string(before->sequence)
                                                       + ": tracks need one connection, in order");
        return same;
    }

private:
    static constexpr std::chrono::seconds still_sends{2};

    struct Last {
        std::string sender, source;
        std::int64_t epoch, sequence;
        std::chrono::steady_clock::time_point received;
        [[nodiscard]] bool is_of(const hive::Event& event) const
        {
            return source == event.identity.source && epoch == event.identity.epoch;
        }
    };
    std::optional<Last> last_, left_;  ///< left_: of the source before that of last_
};

/// When the image was taken, s on a clock of its source: its time in the file that it comes from, or else the time of
/// the capture. @param fps  above 0: images are counted at this rate instead
inline double time_of(const hive::Event& event, double fps)
{
    if (fps > 0)
        return static_cast<double>(event.identity.sequence) / fps;
    const auto found = event.header.find("media_time_us");
    const bool of_a_file = found != event.header.end() && found->is_number();
    return (of_a_file ? found->get<double>() : static_cast<double>(event.identity.monotonic_us)) / 1e6;
}

}  // namespace frame_order
