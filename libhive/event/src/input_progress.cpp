// Counting deliveries at the receiver, and when its sender must hear of it.
#include <hive/event/credit.hpp>
#include <hive/event/input_progress.hpp>
#include <hive/json.hpp>

#include <algorithm>
#include <utility>

namespace hive::event {

using protocol::Request;

namespace {

constexpr std::int64_t told_at_least = 16;  // a stream tells what it has dealt with after so many events

}  // namespace

bool InputProgress::begin(std::int64_t epoch, const ConnectionOptions& options, std::int64_t place, std::int64_t taken)
{
    options_ = options;
    const bool goes_on = place != 0 && place == place_ && taken == arrived();
    if (!goes_on) {
        forget();
        done_ = worked_ = finished_ = most_worked_ = taken;
    }
    place_ = place;
    back_.clear();
    finished_ = std::max(finished_, done_);
    const auto told = goes_on ? 0 : done_;  // what was told last may not have come through
    told_ = {.epoch = epoch, .id = arrived() + options.window, .done = told, .worked = told};
    return goes_on;
}

bool InputProgress::allows(bool lossless) const
{
    const auto most = options_.transfer == Transfer::synchronized ? told_.id
                      : lossless                                  ? most_worked_ + Credit::most_streamed
                                                                  : max_json_integer;
    return arrived() < most;
}

std::int64_t InputProgress::receive(bool lossless, std::int64_t turn)
{
    lossless_ = lossless;
    in_hand_.push_back({.turn = turn, .lossless = lossless});
    return arrived();
}

InputProgress::Delivery* InputProgress::delivery(std::int64_t number)
{
    const auto index = number - done_ - 1;
    return index < 0 || index >= std::ssize(in_hand_) ? nullptr : &in_hand_[static_cast<std::size_t>(index)];
}

void InputProgress::heard(std::int64_t generation, std::int64_t number, bool worked, bool done, bool back)
{
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

/// Is there something to tell that cannot go with a later request?
bool InputProgress::urgent(std::int64_t ask, std::int64_t worked) const
{
    if (!back_.empty())
        return true;
    const bool waits = !all_worked();  // something is being processed, and its end will be told
    if (options_.transfer == Transfer::streaming)
        return (done_ > told_.done || worked > told_.worked)
               && (!waits || lossless_ || worked - told_.worked >= told_at_least);
    return ask > told_.id || (worked > told_.worked && !options_.group.empty()) || (done_ > told_.done && !waits);
}

std::optional<Request> InputProgress::news(bool may_ask)
{
    const auto ask = may_ask ? std::max(told_.id, options_.window + finished_) : told_.id;
    // A stream asks for nothing: what it has processed lets more lossless events come.
    const bool tells = may_ask || options_.transfer != Transfer::streaming;
    const auto worked = tells ? worked_ : std::max(told_.worked, done_);
    return urgent(ask, worked) ? std::optional(tell(ask, worked)) : std::nullopt;
}

std::optional<Request> InputProgress::last_news()
{
    return done_ > told_.done || !back_.empty() ? std::optional(tell(told_.id, worked_)) : std::nullopt;
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
    most_worked_ = std::max(most_worked_, worked);
    Request request = told_;
    request.back = std::exchange(back_, {});
    return request;
}

void InputProgress::forget()
{
    ++generation_;
    in_hand_.clear();
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
