// Faults, pauses, rests, and what is printed.
#include "soak.hpp"

#include <picture.hpp>

#include <algorithm>
#include <iostream>
#include <unistd.h>

namespace hive::soak {
namespace {

using namespace std::chrono_literals;
using namespace mixtures;

constexpr int events_at_once = 100;
constexpr auto between_looks = 250ms;
/// Without a result for so long, `explain` must name a cause. A cut is noticed after 2 s, and made good 1 s after it
/// ends; the rest is for a machine that is busy with other things.
constexpr auto standstill = 9s;
constexpr std::size_t faults_told = 6;

std::string megabytes(std::int64_t bytes) { return std::to_string((bytes + (1 << 19)) >> 20) + " MiB"; }

std::string clock_text(Ground::Clock::duration time)
{
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time).count();
    const auto two = [](std::int64_t number) { return (number < 10 ? "0" : "") + std::to_string(number); };
    return two(seconds / 3600) + ":" + two(seconds / 60 % 60) + ":" + two(seconds % 60);
}

}  // namespace

Soak::Soak(Options options, std::ostream& out)
    : options_(std::move(options)),
      out_(out),
      random_(options_.seed),
      swarm_(make_swarm(random_)),
      ground_(swarm_),
      round_({.seed = options_.seed, .topology = swarm_.topology, .steps = {}}, ground_)
{
    out_ << "seed " << options_.seed << ": " << to_text(swarm_.topology) << "\n";
    for (const auto& [drone, machine] : swarm_.places)
        out_ << (drone == swarm_.places.begin()->first ? "on machines: " : ", ") << drone << "@" << machine;
    out_ << std::endl;
}

int Soak::run()
{
    bool interrupted = false;
    try {
        go_on();
        settle();
        require(ground_.end());
    } catch (const Interrupted&) {
        interrupted = true;
    } catch (const Broken&) {
    } catch (const std::exception& error) {
        problems_.push_back(std::string("not done: ") + error.what());
    }
    interrupted = interrupted || options_.interrupted();
    if (interrupted)
        problems_.clear();  // Ctrl-C ends the commands of this program as well
    line();
    if (!problems_.empty())
        report();
    else
        out_ << (interrupted ? "interrupted" : "done") << ": no promise was broken in "
             << clock_text(Clock::now() - begun_) << " by " << faults_ << " faults; at rest " << rests_
             << " times, audited " << audits_ << " times, asked for a cause " << causes_ << " times" << std::endl;
    return problems_.empty() ? 0 : 1;
}

void Soak::go_on()
{
    const auto end = begun_ + options_.time;
    settle();
    next_fault_ = Clock::now();
    for (bool planted = !options_.plant_loss; Clock::now() < end;) {
        if (!std::exchange(planted, true))
            plant();
        one_fault();
    }
}

void Soak::one_fault()
{
    const auto fault = draw_fault(random_, swarm_);
    if (fault.from_rest)
        settle();
    pause_until(next_fault_, 0);
    pause_until(Clock::now() + std::chrono::milliseconds(random_.between(0, 1000)), events_at_once);
    next_fault_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(options_.fault_every);
    last_faults_.push_back(clock_text(Clock::now() - begun_) + " " + to_text(fault));
    if (last_faults_.size() > faults_told)
        last_faults_.pop_front();
    ++faults_;
    for (const auto& [pause, step] : fault.steps) {
        pause_until(Clock::now() + pause, events_at_once);
        if (pause > 3s && random_.chance(50))
            audit(false);
        if (step.verb == Verb::replace && step.drone == source)
            replaced_ = ground_.statuses().at(source).epoch;
        play(step);
    }
    if (fault.from_rest || random_.chance(60))
        settle();
}

void Soak::feed(const Statuses& statuses, int ahead)
{
    const auto found = statuses.find(source);
    if (found != statuses.end() && ground_.fed() - found->second.outputs.at(0).produced < ahead)
        play({.verb = Verb::feed, .drone = source, .number = ahead});
}

/// A fault of a drone that gives no result and does not say so.
void Soak::plant()
{
    if (const auto done = ground_.hivectl("set b1 emits=false"); done.exit_code != 0)
        require({"not planted: " + done.err});
}

void Soak::play(const Step& step, bool last)
{
    if (options_.interrupted())
        throw Interrupted();
    require(round_.one(step, last));
}

void Soak::pause_until(Clock::time_point end, int ahead)
{
    while (Clock::now() < end) {
        look(ahead);
        std::this_thread::sleep_until(std::min<Clock::time_point>(end, Clock::now() + between_looks));
    }
}

void Soak::look(int ahead)
{
    play({.verb = Verb::rest});
    const auto statuses = ground_.statuses();
    feed(statuses, ahead);
    for (const auto& [name, status] : statuses)
        for (const auto& input : status.inputs)
            oldest_us_ = std::max(oldest_us_, input.last_age_us);
    if (std::exchange(came_before_, came()) != came())
        progressed_ = Clock::now();
    else if (Clock::now() - progressed_ > standstill)
        require_cause();
    if (Clock::now() >= next_line_)
        line();
}

std::int64_t Soak::came() const { return ground_.came().results + ground_.came().exceptions; }

/// Nothing comes. That is right when nothing is left to do.
void Soak::require_cause()
{
    progressed_ = Clock::now();
    const auto statuses = ground_.statuses();
    const auto found = statuses.find(source);
    if (found != statuses.end() && found->second.outputs.at(0).produced >= ground_.fed() && idle(statuses))
        return;
    ++causes_;
    constexpr int found_cause = 9;
    const auto done = ground_.hivectl("explain --json");
    play({.verb = Verb::rest});  // what has come while explain looked
    if (done.exit_code != found_cause && came() == came_before_)
        require({"standstill: no result for " + std::to_string(standstill.count())
                 + " s, and explain names no cause: " + done.out + done.err});
}

void Soak::settle()
{
    play({.verb = Verb::rest, .settle = true}, true);
    progressed_ = Clock::now();
    ++rests_;
    if (replaced_)  // it was to lose nothing that it had sent
        require(round_.missing_of(*replaced_, ground_.newest_of(*replaced_)));
    replaced_.reset();
    audit(true);
    usages_ = ground_.usages();
    require(growth_.look(usages_));
}

void Soak::audit(bool at_rest)
{
    const auto done = ground_.hivectl("audit --json");
    if (options_.interrupted())
        throw Interrupted();
    Known known{.at_rest = at_rest,
                .failures = ground_.came().failures,
                .given_up = ground_.came().given_up,
                .connections = {},
                .breaks = 2 * faults_};
    for (const auto& edge : swarm_.topology.edges())
        known.connections.insert({edge.sender, edge.receiver});
    ++audits_;
    const auto rows = Json::parse(done.out, nullptr, false);
    if (!rows.is_array())
        require({"audit: it prints no rows: " + done.out + done.err});
    auto problems = misjudged(rows, known);
    audited_ = !problems.empty() ? "wrong" : std::to_string(rows.size()) + " rows, exact";
    require(std::move(problems));
}

void Soak::require(Problems problems)
{
    if (problems.empty())
        return;
    problems_ = std::move(problems);
    throw Broken();
}

void Soak::line()
{
    const auto& came = ground_.came();
    std::int64_t memory = 0, descriptors = 0;
    for (const auto& [drone, usage] : usages_) {
        memory = std::max(memory, usage.memory);
        descriptors = std::max(descriptors, usage.descriptors);
    }
    const auto broken = [&](const char* word) {
        return std::ranges::count_if(problems_, [&](auto& problem) { return problem.starts_with(word); });
    };
    out_ << clock_text(Clock::now() - begun_) << "  " << faults_ << " faults, " << came.results << " results, "
         << came.exceptions << " exceptions, " << broken("outcome") << " lost, " << broken("once")
         << " repeated, memory " << megabytes(memory) << ", descriptors " << descriptors << ", oldest "
         << oldest_us_ / 1000 << " ms, audit: " << audited_ << std::endl;
    oldest_us_ = 0;
    next_line_ += 1min;
}

void Soak::report()
{
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < problems_.size() && i < most; ++i)
        out_ << "BROKEN: " << problems_[i] << "\n";
    if (problems_.size() > most)
        out_ << "... and " << problems_.size() - most << " more\n";
    out_ << "the last faults:\n";
    for (const auto& fault : last_faults_)
        out_ << "  " << fault << "\n";
    out_ << picture(ground_.statuses());
    if (!options_.plant_loss) {  // that is a test, and what it finds is no news
        const auto logs = std::filesystem::temp_directory_path() / ("hive-soak-" + std::to_string(::getpid()));
        ground_.save_logs(logs);
        out_ << "\nlogs: " << logs.string();
    }
    out_ << "\nto draw these faults again: scripts/soak --seed " << options_.seed << " --fault-every "
         << options_.fault_every.count() << std::endl;
}

}  // namespace hive::soak
