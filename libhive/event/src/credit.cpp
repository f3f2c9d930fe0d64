// Counts credit, and cuts impossible claims of a peer.
#include <hive/event/credit.hpp>

#include <algorithm>

namespace hive::event {

void Credit::begin(const ConnectionOptions& options, std::int64_t taken, std::int64_t held)
{
    streaming_ = options.transfer == Transfer::streaming;
    window_ = options.window;
    sent_ = taken;
    progress_.asked = taken + std::max<std::int64_t>(window() - held, 0);
    progress_.worked = std::min(progress_.worked, taken);
    events_in_lane_ = bytes_in_lane_ = 0;
}

Progress Credit::request(const Progress& told)
{
    const auto raise = [](std::int64_t& known, std::int64_t claimed) {
        const auto before = known;
        known = std::max(known, claimed);
        return known - before;
    };
    const auto asked = streaming_ ? std::max(told.worked, told.done) + most_streamed : told.asked;
    Progress news;
    news.asked = raise(progress_.asked, std::min(asked, sent_ + window()));
    news.done = raise(progress_.done, std::min(told.done, sent_));
    news.worked = raise(progress_.worked, std::min(std::max(told.worked, progress_.done), sent_));
    return news;
}

void Credit::sent(std::size_t bytes)
{
    ++sent_;
    ++events_in_lane_;
    bytes_in_lane_ += bytes;
}

void Credit::written(std::size_t bytes)
{
    if (events_in_lane_ == 0)
        return;  // it was sent over a connection that this registration has left
    --events_in_lane_;
    bytes_in_lane_ -= std::min(bytes, bytes_in_lane_);
}

bool Credit::open(bool lossless) const
{
    return missing() > 0 || (streaming_ && !lossless && sent_ - progress_.worked < most_unprocessed);
}

std::int64_t Credit::missing() const { return full() ? 0 : progress_.asked - sent_; }

bool Credit::lane_free(std::size_t bytes) const
{
    return events_in_lane_ == 0 || (events_in_lane_ < most_lane_events && bytes_in_lane_ + bytes <= lane_bytes);
}

}  // namespace hive::event
