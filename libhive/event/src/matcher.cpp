// Decides which waiting events make a set, which cannot get a partner, and which delay their source.
#include <hive/event/matcher.hpp>
#include <hive/event/ticket.hpp>

#include <hive/error.hpp>

#include <algorithm>

namespace hive::event {
namespace {

constexpr auto never = Clock::time_point::max();

std::int64_t apart(const Event& one, const Event& other)
{
    return std::abs(one.identity.captured_us - other.identity.captured_us);
}

}  // namespace

Matcher::Matcher(const std::vector<std::string>& inputs, Match match) : match_(match)
{
    if (inputs.size() < 2)
        throw Error(Errc::invalid_argument, "matching takes two inputs or more");
    const auto runs = std::make_shared<Runs>();
    for (const auto& input : inputs)
        lines_.emplace_back(input, runs);
}

std::size_t Matcher::index_of(const std::string& input) const
{
    const auto found = std::ranges::find(lines_, input, &WaitingLine::input);
    if (found == lines_.end())
        throw Error(Errc::invalid_argument, input + " is not among the matched inputs");
    return static_cast<std::size_t>(found - lines_.begin());
}

void Matcher::push(Event event, TimePoint now)
{
    const auto input = index_of(event.input);
    if (!std::exchange(begun_, true))
        for (auto& line : lines_)
            line.begin(now);
    WaitingLine& line = lines_[input];
    line.hear(event, now);
    if (!match_.tolerance && line.find(event.identity)) {
        ++counts_.duplicates;
        conclude(event, Ending::duplicate);
        return;
    }
    line.add(std::move(event), now + timeout);
    if (match_.tolerance)
        make_nearest_sets(now);
    else if (const auto places = exact_set(line.events().back()))
        make_set(*places);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        drop_hopeless(i);
        drop_late(i, now);
    }
    for (std::size_t i = 0; i < lines_.size(); ++i)
        give_back(i, now);
}

void Matcher::expire(TimePoint now)
{
    for (auto& line : lines_)
        line.leave_out_silent_senders(now - timeout);
    if (const auto due = deadline(); !due || *due > now)
        return;
    if (match_.tolerance)
        make_nearest_sets(now);
    for (std::size_t i = 0; i < lines_.size(); ++i) {
        drop_late(i, now);
        give_back(i, now);
        for (auto& waiting : lines_[i].events())
            if (waiting.due <= now)  // lossless: it stays, and is checked again while it delays its source
                waiting.due = waiting.event.ticket.processing() ? now + timeout / 4 : never;
    }
}

void Matcher::finish()
{
    if (match_.tolerance)
        make_nearest_sets(never);
    for (std::size_t i = 0; i < lines_.size(); ++i)
        while (!lines_[i].events().empty())
            give_up(i, 0);
}

std::optional<Matcher::Set> Matcher::pop()
{
    if (ready_.empty())
        return std::nullopt;
    Set set = std::move(ready_.front());
    ready_.pop_front();
    return set;
}

std::optional<Matcher::TimePoint> Matcher::deadline() const
{
    TimePoint first = never;
    for (const auto& line : lines_)
        for (const auto& waiting : line.events())
            first = std::min(first, waiting.due);
    return first == never ? std::nullopt : std::optional(first);
}

MatchCounts Matcher::counts() const
{
    MatchCounts counts = counts_;
    for (const auto& line : lines_)
        counts.waiting += static_cast<std::int64_t>(line.events().size());
    return counts;
}

/// Are these two inputs compared? By time, each is compared with the first.
bool Matcher::compared(std::size_t one, std::size_t other) const
{
    return one != other && (!match_.tolerance || one == 0 || other == 0);
}

std::optional<std::size_t> Matcher::partner(const Waiting& waiting, std::size_t other) const
{
    const WaitingLine& line = lines_[other];
    if (!match_.tolerance)
        return line.find(waiting.event.identity);
    const auto place = line.nearest(waiting.event.identity.captured_us);
    return place && apart(line.events()[*place].event, waiting.event) <= match_.tolerance->count() ? place
                                                                                                   : std::nullopt;
}

std::optional<Matcher::Places> Matcher::exact_set(const Waiting& newest) const
{
    Places places;
    for (std::size_t i = 0; i < lines_.size(); ++i)
        if (const auto place = partner(newest, i))
            places.push_back(*place);
    return places.size() == lines_.size() ? std::optional(places) : std::nullopt;
}

/// The event of another input that is mutually nearest to one of the first input, once no later event can change that.
std::optional<std::size_t> Matcher::nearest_partner(std::size_t first, std::size_t other, TimePoint now) const
{
    const Waiting& here = lines_[0].events()[first];
    const auto place = partner(here, other);
    if (!place)
        return std::nullopt;
    const Waiting& there = lines_[other].events()[*place];
    if (lines_[0].nearest(there.event.identity.captured_us) != first)
        return std::nullopt;
    const bool decided = lines_[other].heard_until() >= here.event.identity.captured_us
                         && lines_[0].heard_until() >= there.event.identity.captured_us;
    return decided || here.due <= now || there.due <= now ? place : std::nullopt;
}

std::optional<Matcher::Places> Matcher::nearest_set(TimePoint now) const
{
    for (std::size_t first = 0; first < lines_[0].events().size(); ++first) {
        Places places{first};
        for (std::size_t other = 1; other < lines_.size(); ++other)
            if (const auto place = nearest_partner(first, other, now))
                places.push_back(*place);
        if (places.size() == lines_.size())
            return places;
    }
    return std::nullopt;
}

void Matcher::make_nearest_sets(TimePoint now)
{
    while (const auto places = nearest_set(now))
        make_set(*places);
}

void Matcher::make_set(const Places& places)
{
    Set set;
    for (std::size_t i = 0; i < lines_.size(); ++i)
        set.push_back(lines_[i].take(places[i]));
    ready_.push_back(std::move(set));
    ++counts_.sets;
}

/// Drops an event that cannot get a partner, and the events of the same capture that wait for it.
void Matcher::give_up(std::size_t input, std::size_t place)
{
    const Waiting& waiting = lines_[input].events()[place];
    std::vector<std::pair<std::size_t, std::size_t>> gone{{input, place}};
    std::vector<std::size_t> lacking;
    for (std::size_t other = 0; other < lines_.size(); ++other)
        if (compared(input, other)) {
            const auto there = partner(waiting, other);
            if (!there)
                lacking.push_back(other);
            else if (!match_.tolerance)  // the other has lost its only partner; by time it may match another
                gone.emplace_back(other, *there);
        }
    if (lacking.empty())  // its nearest partner matched another event
        lacking.push_back(input == 0 ? 1 : 0);
    for (const auto other : lacking)
        counts_.missing[lines_[other].input()] += std::ssize(gone);
    counts_.unmatched += std::ssize(gone);
    for (const auto& [line, position] : gone)
        conclude(lines_[line].take(position), Ending::unmatched);
}

/// Is it certain that its partner at that input cannot arrive any more?
bool Matcher::hopeless(const Waiting& waiting, std::size_t other) const
{
    const Identity& identity = waiting.event.identity;
    if (!match_.tolerance)
        return lines_[other].passed(identity) && !partner(waiting, other);
    return lines_[other].heard_until() > identity.captured_us + match_.tolerance->count() && !partner(waiting, other);
}

/// Has that input passed this event, so that waiting is useless?
bool Matcher::overtaken(const Waiting& waiting, std::size_t other) const
{
    const Identity& identity = waiting.event.identity;
    return match_.tolerance ? lines_[other].heard_until() >= identity.captured_us : lines_[other].overtook(identity);
}

void Matcher::drop_hopeless(std::size_t input)
{
    auto& events = lines_[input].events();
    for (std::size_t place = 0; place < events.size();) {
        bool lost = false;
        for (std::size_t other = 0; other < lines_.size() && !lost; ++other)
            if (compared(input, other)) {
                events[place].overtaken = events[place].overtaken || overtaken(events[place], other);
                lost = hopeless(events[place], other);
            }
        if (lost)
            give_up(input, place);
        else
            ++place;
    }
}

void Matcher::drop_late(std::size_t input, TimePoint now)
{
    WaitingLine& line = lines_[input];
    while (line.overfull())
        give_up(input, 0);
    for (std::size_t place = 0; place < line.events().size();) {
        const Waiting& waiting = line.events()[place];
        if (!waiting.event.identity.lossless && waiting.due <= now)
            give_up(input, place);
        else
            ++place;
    }
}

/// Is the input of the missing partner still active?
bool Matcher::holds_up(const Waiting& waiting, std::size_t input, TimePoint now) const
{
    for (std::size_t other = 0; other < lines_.size(); ++other)
        if (compared(input, other) && lines_[other].heard_at() + timeout <= now && !partner(waiting, other))
            return false;
    return !waiting.overtaken;
}

void Matcher::give_back(std::size_t input, TimePoint now)
{
    int ahead = 0;
    for (auto& waiting : lines_[input].events()) {
        const bool lossless = waiting.event.identity.lossless;
        ahead += lossless && !waiting.overtaken ? 1 : 0;
        if (waiting.event.ticket.processing() && (!lossless || ahead <= most_ahead || !holds_up(waiting, input, now)))
            waiting.event.ticket.stop_processing();
    }
}

Identity identity_of(const std::vector<Event>& set)
{
    Identity identity = set.front().identity;
    for (const auto& event : set)
        for (const auto& hop : event.identity.hops)
            if (std::ranges::find(identity.hops, hop.drone, &Hop::drone) == identity.hops.end())
                identity.hops.push_back(hop);
    return identity;
}

}  // namespace hive::event
