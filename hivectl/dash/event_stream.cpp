#include "event_stream.hpp"

namespace hivectl::dash {

void EventStream::begin(hive::http::Clock::time_point now)
{
    const auto newest = newest_(now);
    if (newest && newest->version != version_) {
        version_ = newest->version;
        text_ = "data: " + newest->text + "\n\n";
    } else if (now - begun_ >= repeat_)
        text_ = ":\n\n";
    else
        return;
    begun_ = now;
    sent_ = 0;
}

std::size_t EventStream::read(std::span<char> to, hive::http::Clock::time_point now)
{
    if (sent_ == text_.size())
        begin(now);
    const auto count = text_.copy(to.data(), to.size(), sent_);
    sent_ += count;
    return count;
}

}  // namespace hivectl::dash
