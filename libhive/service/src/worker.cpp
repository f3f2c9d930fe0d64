// Takes commands and events out of the mailbox and runs the author's code on them.
#include "worker.hpp"

#include <hive/event/ticket.hpp>

#include <algorithm>

namespace hive::service {

using event::Clock;

namespace {

constexpr auto never = Clock::time_point::max();
constexpr auto pause_after_failure = std::chrono::milliseconds(100);  ///< a main that keeps throwing must not spin

void conclude_all(const Set& set, event::Ending ending)
{
    for (const auto& event : set)
        conclude(event, ending);
}

}  // namespace

void Worker::run()
{
    while (!parts_.board.stopping())
        work_once();
    parts_.board.ended();
}

/// The end of the time is delivered as a command, since the end of a wait could not be distinguished from a wake-up for
/// main.
void Worker::run(Clock::time_point until)
{
    const auto over = std::make_shared<bool>(false);
    platform::Timer timer(parts_.module.context());
    parts_.module.call([&] { timer.run_at(until, [this, over] { parts_.mailbox.push([over] { *over = true; }); }); });
    while (!*over && !parts_.board.stopping())
        work_once();
    parts_.module.call([&] { timer.cancel(); });
    if (parts_.board.stopping())
        parts_.board.ended();
}

/// The next item, or main when it is due.
void Worker::work_once()
{
    auto item = parts_.module.next(parts_.mailbox, next_deadline());
    if (item) {
        if (auto* command = std::get_if<event::Mailbox::Command>(&*item))
            (*command)();
        else
            deliver(std::move(std::get<Event>(*item)));
    }
    work_on_sets();
    if (steps() && !parts_.board.stopping() && (!item || Clock::now() >= next_step_))
        step();
}

bool Worker::steps() const { return parts_.declaration.main && !parts_.board.halted(); }

Clock::time_point Worker::next_deadline() const
{
    auto first = steps() ? next_step_ : never;
    for (const auto& matching : parts_.declaration.matchings)
        first = std::min(first, matching.matcher.deadline().value_or(never));
    return first;
}

void Worker::step()
{
    parts_.board.begin_work("main");
    try {
        next_step_ = Clock::now() + parts_.declaration.main();
    } catch (const CaptureFailed& error) {
        failed({}, error, &error.lost());
    } catch (...) {
        failed({}, current_error());
    }
    parts_.board.end_work();
}

void Worker::halt(const std::string& by)
{
    parts_.board.halt(by);
    parts_.module.halt(true);
    parts_.mailbox.discard(event::came_to_member);  // other members may process them
    parts_.mailbox.nudge();
}

void Worker::resume()
{
    parts_.mailbox.discard([](const Event& event) { return !event.identity.lossless; });
    parts_.board.resume();
    parts_.module.halt(false);
    parts_.mailbox.nudge();  // what was asked for meanwhile has not woken main
}

void Worker::inputs_ended(const std::string& text, const std::function<bool()>& still)
{
    for (auto& matching : parts_.declaration.matchings)
        matching.matcher.finish();
    work_on_sets();
    try {
        parts_.declaration.on_end(text);
    } catch (...) {
        failed({}, current_error());
    }
    parts_.emitter.end_all(text, still);
}

std::optional<Error> Worker::try_out(const Json& values)
try {
    next_step_ = Clock::now();
    parts_.declaration.parameters.assign(values);
    parts_.declaration.on_change();
    parts_.declaration.parameters.require_tellable();
    return std::nullopt;
} catch (...) {
    const Error error = current_error();
    put_back();
    return error;
}

void Worker::put_back()
try {
    next_step_ = Clock::now();
    parts_.declaration.parameters.put_back();
    parts_.declaration.on_change();
} catch (...) {
    parts_.reporter.report(current_error());
}

/// Rejects duplicates here and not on arrival, because an event that is discarded in the queue has not been processed.
void Worker::deliver(Event&& event)
{
    if (!filters_[event.input].first(event))
        return conclude(event, event::Ending::duplicate);
    for (auto& matching : parts_.declaration.matchings)
        if (const auto* input = matching.input(event.input))
            return to_partners(std::move(event), matching, *input);
    Set set;
    set.push_back(std::move(event));
    const auto callback = [&] {
        require_type(set.front());
        parts_.declaration.callbacks.at(set.front().input)(set.front());
    };
    if (work(set, callback))
        conclude_all(set, event::Ending::processed);
}  // the tickets are released with the set, which requests the next event unless the drone has halted

void Worker::to_partners(Event event, MatchedInputs& matching, const MatchedInput& input)
{
    Set single;
    single.push_back(std::move(event));
    const auto check = [&] {
        require_type(single.front());
        if (input.check)
            input.check(single.front());
    };
    if (work(single, check))
        matching.matcher.push(std::move(single.front()), Clock::now());
}

void Worker::work_on_sets()
{
    auto& matchings = parts_.declaration.matchings;
    for (std::size_t i = 0; i < matchings.size(); ++i) {
        auto& matching = matchings[i];
        matching.matcher.expire(Clock::now());
        while (!parts_.board.halted() && !parts_.board.stopping())
            if (const auto set = matching.matcher.pop()) {
                if (work(*set, [&] { matching.callback(*set); }))
                    conclude_all(*set, event::Ending::processed);
            } else {
                break;
            }
        parts_.board.matched(i, matching.matcher.counts());
    }
}

/// @return whether the callback returned without an exception
bool Worker::work(const Set& set, const std::function<void()>& callback)
{
    parts_.board.begin_work(set.front().input);
    parts_.emitter.begin(set);
    bool done = false;
    try {
        callback();
        done = true;
    } catch (...) {
        failed(set, current_error());
    }
    parts_.emitter.finish();
    parts_.board.end_work();
    return done;
}

/// @param set  empty: main failed
/// @param lost  then the item that it could not send, if that has an identity
void Worker::failed(const Set& set, const Error& error, const Event* lost)
{
    if (!set.empty())
        parts_.failures.threw(error, set);  // before it is reported, so that readers of the report find it
    parts_.reporter.report(error, set.empty() ? lost : &set.front());
    if (set.empty())
        next_step_ = Clock::now() + pause_after_failure;
    conclude_all(set, event::Ending::abandoned);
    if (parts_.board.policy() == ExceptionPolicy::halt)
        halt();
}

void Worker::require_type(const Event& event) const
{
    const auto* input = parts_.declaration.interface.input(event.input);
    if (!types_fit(event.type, input->type))
        throw Error(Errc::type_mismatch, event.sender + "." + event.output + " sent " + event.type + ", but "
                                             + event.input + " takes " + input->type);
}

}  // namespace hive::service
