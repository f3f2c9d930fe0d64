// Prepares a set on all drones at once, and decides.
#include "joint_set.hpp"

#include "application_core.hpp"

#include <hive/protocol/requests.hpp>

#include <algorithm>

namespace hive {

using event::Clock;
using protocol::PacketType;
using std::chrono::milliseconds;

namespace {

/// A drone answers the decision at once, or is disconnected after 2 s of inactivity.
constexpr milliseconds decision_timeout(3000);
/// An abort is valid without an answer; the wait is for the drone to be free for the next attempt.
constexpr milliseconds abort_timeout(500);
constexpr milliseconds look_period(20);  ///< of polling for cancellation

const Error* error_in(const std::optional<event::Outcome>& outcome)
{
    return outcome ? std::get_if<Error>(&*outcome) : nullptr;
}

}  // namespace

std::int64_t deadline_ms_before(Clock::time_point deadline)
{
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now()).count();
    return std::max<std::int64_t>(left - std::min<std::int64_t>(left / 16, 100), 1);
}

void JointSet::Part::let_go()
{
    over = true;
    if (link)
        link->held = false;
}

JointSet::JointSet(event::Module& module, Terms terms) : module_(module), terms_(std::move(terms)) {}

SetResult JointSet::run()
{
    for (;;) {
        prepare();
        if (!terms_.cancelled() && commit())
            return committed();
        abort();
        if (!only_locked())
            return unchanged();
        pause();
        if (terms_.cancelled() || Clock::now() >= terms_.deadline)
            return unchanged();
    }
}

void JointSet::prepare()
{
    parts_.clear();
    for (const auto& [drone, place] : terms_.drones)
        parts_.push_back(std::make_shared<Part>(drone));
    token_ = static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(max_json_integer));
    module_.call([this] {
        for (std::size_t i = 0; i < parts_.size(); ++i)
            if (const auto* place = std::get_if<Place>(&terms_.drones[i].second))
                prepare(parts_[i], *place);
            else
                parts_[i]->prepared = std::get<Error>(terms_.drones[i].second);
    });
    wait(Clock::time_point::max(), &JointSet::prepared_or_refused, terms_.cancelled);
}

void JointSet::prepare(const PartPtr& part, const Place& place)
{
    module_.with_link(transport::parse_address(place.address), terms_.deadline,
                      [this, part, place](const Result<event::LinkPtr>& found) {
                          if (part->over)
                              return;  // this object may be destroyed
                          const auto link = value_or_none(found);
                          const auto wrong = link ? wrong_peer(place, *link) : std::optional(*error_of(found));
                          if (wrong)
                              part->prepared = *wrong;
                          else
                              ask_to_prepare(part, link);
                      });
}

void JointSet::ask_to_prepare(const PartPtr& part, const event::LinkPtr& link)
{
    part->link = link;
    link->held = true;
    const auto deadline_ms = std::min(deadline_ms_before(terms_.deadline), protocol::Set::max_prepare_ms);
    const Json header{{"parameters", terms_.parameters}, {"prepare", token_}, {"deadline_ms", deadline_ms}};
    link->request(PacketType::set, header, {}, terms_.deadline, [part](const event::Outcome& outcome) {
        if (!part->over)
            part->prepared = outcome;
    });
    module_.arm();
}

/// Decides, in one task: all are prepared and connected, and each gets the decision before any answer is awaited.
/// @return  false: no drone got the decision
bool JointSet::commit()
{
    bool decided = false;
    module_.call([&] {
        if (lost_one() || !all_prepared() || Clock::now() >= terms_.deadline)
            return;
        decided = true;
        for (const auto& part : parts_)
            tell(part, "commit", Clock::now() + decision_timeout);
    });
    if (decided)
        wait(Clock::time_point::max(), &JointSet::all_decided, [] { return false; });
    return decided;
}

void JointSet::abort()
{
    module_.call([&] {
        for (const auto& part : parts_)
            if (part->link && may_hold(*part))
                tell(part, "abort", Clock::now() + abort_timeout);
            else
                part->let_go();
    });
    wait(Clock::time_point::max(), &JointSet::all_decided, [] { return false; });
}

/// A drone that did not answer in time may still prepare later, so it is aborted too.
bool JointSet::may_hold(const Part& part)
{
    const auto* error = error_in(part.prepared);
    return !error || error->code() == Errc::timeout;
}

void JointSet::tell(const PartPtr& part, const char* decision, Clock::time_point until)
{
    part->let_go();
    if (!part->link->open()) {
        part->decided = Error(Errc::connection_lost, "the connection has ended");
        return;
    }
    part->link->request(PacketType::set, {{decision, token_}}, {}, until,
                        [part](const event::Outcome& outcome) { part->decided = outcome; });
    module_.arm();
}

/// A random pause that grows, so that two conflicting sets are ever less likely to conflict again.
void JointSet::pause()
{
    const auto most = std::int64_t{4} << std::min(attempts_++, 5);
    const milliseconds time(std::uniform_int_distribution<std::int64_t>(1, most)(random_));
    wait(std::min(Clock::now() + time, terms_.deadline), &JointSet::none, terms_.cancelled);
}

void JointSet::wait(Clock::time_point until, Condition done, const std::function<bool()>& cancelled)
{
    for (bool is_done = false; !is_done && !cancelled() && Clock::now() < until;)
        module_.loop().wait(std::min(until, Clock::now() + look_period), [&] { return is_done = (this->*done)(); });
}

bool JointSet::prepared_or_refused()
{
    return lost_one() || all_prepared()
           || std::ranges::any_of(parts_, [](const PartPtr& part) { return error_in(part->prepared); });
}

bool JointSet::all_prepared()
{
    return std::ranges::all_of(
        parts_, [](const PartPtr& part) { return part->prepared.has_value() && !error_in(part->prepared); });
}

bool JointSet::all_decided()
{
    return std::ranges::all_of(
        parts_, [](const PartPtr& part) { return part->decided || error_in(part->prepared) || !part->link; });
}

/// Has one exited after it had prepared? Then it is the reason why the others are unchanged.
bool JointSet::lost_one()
{
    for (const auto& part : parts_)
        if (part->prepared && !error_in(part->prepared) && !part->link->open()) {
            part->prepared = Error(Errc::connection_lost, "its connection was lost before the commit");
            return true;
        }
    return false;
}

bool JointSet::only_locked() const
{
    bool locked = false;
    for (const auto& part : parts_)
        if (const auto* error = error_in(part->prepared)) {
            if (error->code() != Errc::locked)
                return false;
            locked = true;
        }
    return locked;
}

SetResult JointSet::unchanged() const
{
    const auto culprit = std::ranges::find_if(parts_, [](const PartPtr& part) { return error_in(part->prepared); });
    const std::string why = culprit == parts_.end()
                                ? (terms_.cancelled() ? "the set was cancelled" : "the set timed out")
                                : (*culprit)->drone + " could not be set";
    SetResult result{.answers = {}, .changed = SetResult::Changed::none};
    for (const auto& part : parts_)
        if (const auto* error = error_in(part->prepared))
            result.answers.push_back({part->drone, named(part->drone, *error)});
        else
            result.answers.push_back({part->drone, Error(Errc::refused, part->drone + ": unchanged, because " + why)});
    return result;
}

SetResult JointSet::committed() const
{
    SetResult result{.answers = {}, .changed = SetResult::Changed::all};
    for (const auto& part : parts_) {
        const auto* error = error_in(part->decided);
        if (!error) {
            result.answers.push_back({part->drone, std::get<Json>(*part->decided).value("parameters", Json::object())});
            continue;
        }
        result.changed = SetResult::Changed::unclear;
        const bool unknown = error->code() == Errc::connection_lost || error->code() == Errc::timeout;
        result.answers.push_back(
            {part->drone,
             Error(unknown ? Errc::connection_lost : error->code(),
                   part->drone + (unknown ? ": unknown whether it has the new values: " : ": kept its old values: ")
                       + error->what())});
    }
    return result;
}

}  // namespace hive
