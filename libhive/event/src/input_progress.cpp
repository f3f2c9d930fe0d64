// Counts deliveries at the receiver, and decides when to report them to the sender.
#include <hive/event/credit.hpp>
#include <hive/event/input_progress.hpp>
#include <hive/json.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

using protocol::Request;

namespace {

constexpr std::int64_t most_unreported = 16;  // processed deliveries of a stream

}  // namespace

bool InputProgress::begin(std::int64_t epoch, const ConnectionOptions& options, std::int64_t place, std::int64_t taken,
                          std::int64_t held)
{
    options_ = options;
    const bool goes_on = place != 0 && place == place_ && taken == arrived();
    if (!goes_on) {
        forget();
        done_ = worked_ = finished_ = taken;
    }
    place_ = place;
    if (!goes_on)
        back_.clear();
    else
        for (const auto& each : returned_)
            back_.push_back(each.number);
    returned_.clear();
    finished_ = std::max(finished_, done_);
    prompt_until_ = arrived() + 1;
    const auto told = goes_on ? 0 : done_;  // the last report may have been lost
    const auto asks = [&](std::int64_t window) { return arrived() + std::max<std::int64_t>(window - held, 0); };
    told_ = {.epoch = epoch, .id = asks(options.window), .done = told, .worked = told};
    allowed_ = options.transfer == Transfer::streaming ? asks(Credit::most_streamed) : told_.id;
    return goes_on;
}

std::int64_t InputProgress::place() const
{
    const auto all = static_cast<std::int64_t>(back_.size() + returned_.size()) + arrived() - finished_;
    return options_.group.empty() || all <= protocol::Request::most_back ? place_ : 0;
}

bool InputProgress::allows(bool lossless) const
{
    return arrived() < allowed_ || (options_.transfer == Transfer::streaming && !lossless);
}

std::int64_t InputProgress::receive(bool lossless, std::int64_t turn)
{
    in_hand_.push_back({.turn = turn, .lossless = lossless});
    if (lossless)
        prompt_until_ = arrived();
    while (!returned_.empty() && returned_.front().until < arrived())
        returned_.pop_front();
    return arrived();
}

InputProgress::Delivery* InputProgress::delivery(std::int64_t number)
{
    const auto index = number - done_ - 1;
    return index < 0 || index >= std::ssize(in_hand_) ? nullptr : &in_hand_[static_cast<std::size_t>(index)];
}

void InputProgress::heard(std::int64_t generation, std::int64_t number, bool worked, bool done, bool back)
{
    const bool forgotten = generation >= 0 && generation < generation_;
    unprocessed_before_ -= forgotten && worked ? 1 : 0;
    owed_before_ -= forgotten && done ? 1 : 0;
    Delivery* one = generation == generation_ ? delivery(number) : nullptr;
    if (!one)
        return;
    finished_ += worked && !one->worked ? 1 : 0;
    one->worked = one->worked || worked;
    one->done = one->done || done;
    if (back && !options_.group.empty())
        back_.push_back(number);
    for (; !in_hand_.empty() && in_hand_.front().done && in_hand_.front().worked; in_hand_.pop_front())
        ++done_;
    worked_ = done_ + (std::ranges::find(in_hand_, false, &Delivery::worked) - in_hand_.begin());
}

/// The number up to which the sender may deliver once it has this request.
std::int64_t InputProgress::allowed(std::int64_t ask, std::int64_t worked) const
{
    return std::max(allowed_, options_.transfer == Transfer::streaming ? worked + Credit::most_streamed : ask);
}

/// Is there a report that cannot go with a later request? @param more  the report lets the sender deliver more
/// @param waits  an event is being processed, and its end will be reported
bool InputProgress::urgent(std::int64_t worked, bool more, bool waits) const
{
    if (!back_.empty())
        return true;
    if (options_.transfer == Transfer::streaming)
        return (done_ > told_.done || worked > told_.worked || more)
               && (told_.done < prompt_until_
                   || std::max(worked - told_.worked, done_ - told_.done) >= most_unreported);
    return more || (worked > told_.worked && !options_.group.empty()) || (done_ > told_.done && !waits);
}

std::optional<Request> InputProgress::news(bool may_ask, bool late, std::int64_t held_before)
{
    const auto before = unprocessed_before_ + held_before;
    const auto ask = may_ask ? std::max(told_.id, options_.window + finished_ - before) : told_.id;
    // A stream asks for nothing: what it has processed lets more lossless events come.
    const bool tells = (may_ask && before == 0) || options_.transfer != Transfer::streaming;
    const auto worked = tells ? worked_ : std::max(told_.worked, done_);
    const bool more = tells && allowed(ask, worked) > allowed_;
    const bool waits = may_ask && !all_worked();  // while paused, the rest may wait for long
    const bool due = late ? done_ > told_.done || worked > told_.worked : urgent(worked, more, waits);
    return due ? std::optional(tell(ask, worked)) : std::nullopt;
}

bool InputProgress::has_late_news() const
{
    return options_.transfer == Transfer::streaming && (done_ > told_.done || worked_ > told_.worked);
}

std::optional<Request> InputProgress::last_news()
{
    const bool any = done_ > told_.done || worked_ > told_.worked || !back_.empty();
    return any ? std::optional(tell(told_.id, worked_)) : std::nullopt;
}

Request InputProgress::acknowledge_all()
{
    const auto all = arrived();
    forget();
    done_ = all;
    return tell(told_.id, done_);
}

Request InputProgress::tell(std::int64_t ask, std::int64_t worked)
{
    told_.id = ask;
    told_.worked = worked;
    told_.done = done_;
    for (const auto number : back_)
        returned_.push_back({number, allowed_});
    allowed_ = allowed(ask, worked);
    Request request = told_;
    request.back = std::exchange(back_, {});
    return request;
}

void InputProgress::forget()
{
    ++generation_;
    unprocessed_before_ = held(true);
    owed_before_ = held(false);
    in_hand_.clear();
    worked_ = finished_ = done_;
}

bool InputProgress::lossless_in_hand() const { return std::ranges::any_of(in_hand_, &Delivery::lossless); }

bool InputProgress::owes() const
{
    return std::ranges::any_of(in_hand_, [](const Delivery& each) { return each.worked && !each.done; });
}

std::vector<std::int64_t> InputProgress::turns() const
{
    std::vector<std::int64_t> turns;
    for (const auto& each : in_hand_)
        if (each.turn != 0 && !each.done)
            turns.push_back(each.turn);
    return turns;
}

}  // namespace hive::event
