// Runs simulated drones, reads their statuses, and collects.
#include "drones.hpp"
#include "programs.hpp"
#include "simulated_ground.hpp"

#include <orders.hpp>

#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <tuple>

namespace hive::simulation {

using namespace std::chrono_literals;
using mixtures::Statuses;
using mixtures::Topology;

namespace {

Json first_parameters(const Topology& topology, const std::string& drone, std::int64_t fed, bool ends)
{
    if (drone == mixtures::source)
        return {{"pace", topology.demand ? "demand" : "live"}, {"fps", 200}, {"count", fed}, {"ends", ends}};
    if (!topology.is_worker(drone))
        return Json::object();
    return {{"work_ms", mixtures::first_setting.work_ms},
            {"most_ms", mixtures::first_setting.most_ms},
            {"throw_every", topology.stages.at(topology.stage_of(drone)).throw_every}};
}

/// Each kind is there twice, so that a drone can be replaced by one of another kind.
Interface interface_of_kind(const std::string& kind)
{
    EmbeddedDrone embedded({kind, "of a simulated round"}, {.name = "described"});
    if (kind.starts_with("ticker"))
        source(embedded.drone());
    else if (kind.starts_with(mixtures::forker))
        fork(embedded.drone());
    else if (kind.starts_with(mixtures::joiner))
        pair(embedded.drone());
    else
        worker(embedded.drone());
    return embedded.interface();
}

constexpr auto time_to_replace = 5s;
constexpr auto turn_time = 20ms;  ///< of the collector, which has two things to wait for

}  // namespace

std::set<std::string> peers(const Topology& topology)
{
    std::set<std::string> names{"collector", mixtures::hearer};
    for (const auto& drone : topology.drones())
        names.insert(drone);
    if (!topology.bystanders.empty())
        names.insert("branch");
    return names;
}

Application::Options application_named(const std::string& name, std::chrono::milliseconds timeout)
{
    Application::Options options;
    options.name = name;
    options.timeout = timeout;
    return options;
}

void Trace::line(const std::string& who, const std::string& what) const
{
    if (wanted_)
        std::cout << std::fixed << std::setprecision(6) << std::chrono::duration<double>(world().age()).count() << "  "
                  << who << ": " << what << "\n";
}

SimulatedGround::SimulatedGround(World& world, const mixtures::Plan& plan, const Trace& trace)
    : world_(world),
      topology_(plan.topology),
      faults_(plan.faults),
      freezes_(std::ranges::count(plan.steps, mixtures::Verb::freeze, &mixtures::Step::verb) > 0),
      trace_(trace),
      links_(peers(topology_)),
      calls_(Application::Options().timeout),
      waits_(2 * turn_time),
      impatient_calls_(short_timeout),
      replaces_(time_to_replace)
{
    programs() = {.start = [this](const auto& words) -> Process& { return start_program(words); },
                  .describe = [](const auto& kind) { return interface_of_kind(kind); }};
    if (has(mixtures::fault::clocks) || has(mixtures::fault::part))
        part_clocks();
    for (const auto& drone : topology_.drones()) {
        start(drone, false);
        born_[drone] = 0;
    }
    collected_.process = &world_.spawn("collector", [this] { collect(); });
    until([this] { return collected_.begun; });
    if (has(mixtures::fault::join)) {
        branching_ = &world_.spawn("branch", [this] { collect_branch(); });
        until([this] { return branch_.has_value(); });
    }
    application_.emplace(application_named("operator"));
    impatient_.emplace(application_named("impatient", short_timeout));
}

/// After a failed round the drones still run and use this.
SimulatedGround::~SimulatedGround()
{
    ending_ = true;
    if (watching_ && !world_.current()->dead)
        until([this] { return watching_->dead; });  // its destructors must not be cut off
    for (auto* const guest : guests_)
        world_.kill(*guest);
    for (const auto& [drone, running] : running_)
        world_.kill(*running->process);
    for (const auto& [drone, successor] : successors_)
        world_.kill(*successor->process);
    if (world_.current()->dead) {
        world_.kill(*collected_.process);
        if (branching_)
            world_.kill(*branching_);
        return;
    }
    collected_.ending = true;
    until([this] { return collected_.process->dead && (!branching_ || branching_->dead); });
}

/// Half of the drones are on a machine whose clock is wrong, and not as fast as that of the other one.
void SimulatedGround::part_clocks()
{
    const auto offset = world_.between(10s, 1h);
    if (has(mixtures::fault::clocks))
        world_.set_clock(1, {.offset = world_.chance(50) ? offset : -offset,
                             .drift_ppm = static_cast<std::int64_t>(world_.chance_of(401)) - 200});
    for (const auto& drone : topology_.drones())
        machines_[drone] = static_cast<int>(world_.chance_of(2));
}

int SimulatedGround::machine_of(const std::string& drone) const
{
    const auto found = machines_.find(drone);
    return found == machines_.end() ? 0 : found->second;
}

/// A peer's clock is assumed to be read halfway between query and answer. A peer that is frozen or silenced meanwhile
/// causes an error of half of the time.
std::optional<std::chrono::microseconds> SimulatedGround::age_error() const
{
    if (has(mixtures::fault::clock_step))
        return std::nullopt;
    if (!has(mixtures::fault::clocks) && !has(mixtures::fault::part))
        return 0us;  // on one machine, where no clock is read from afar
    return freezes_ || has(mixtures::fault::silence) || has(mixtures::fault::part) ? 3s : 30ms;
}

void SimulatedGround::until(const std::function<bool()>& condition)
{
    while (!condition())
        world_.sleep(1ms);
}

void SimulatedGround::at_once(const std::function<void()>& one, const std::function<void()>& other)
{
    const auto& beside = world_.spawn("beside", one);
    const auto wait = [&] { until([&] { return beside.dead; }); };
    try {
        other();
    } catch (...) {
        wait();  // it uses what the caller has
        throw;
    }
    wait();
}

/// @param writes  after which it dies
void SimulatedGround::start(const std::string& drone, bool remembers, std::optional<int> writes)
{
    if (drone == mixtures::source && !remembers)
        fed_ = 1;
    born_[drone] = ++starts_;
    links_.broken(drone, world_.now());
    EmbeddedOptions options{.name = drone};
    options.ends_process = true;
    if (!remembers)
        options.parameters = first_parameters(topology_, drone, fed_, has(mixtures::fault::ends));
    const auto running = running_[drone] = std::make_shared<Running>();
    options.log = log_of(drone, running);
    running->process = &world_.spawn(drone, [this, drone, remembers, options, running] {
        EmbeddedDrone embedded({kind_of(drone, remembers), "of a simulated round"}, options);
        live(drone, embedded, running);
    });
    running->process->writes_left = writes;
    running->process->machine = machine_of(drone);
    until([&] { return running->ready || running->process->dead; });
    links_.mended(drone, world_.now());
}

/// The program that last had the name, or the one of the beginning.
std::string SimulatedGround::kind_of(const std::string& drone, bool remembers) const
{
    const auto state = remembers ? event::Home(event::default_home()).read_state(drone) : std::nullopt;
    return state                           ? state->value("kind", "")
           : drone == mixtures::source     ? "ticker"
           : topology_.is_bystander(drone) ? drone
                                           : "sleeper";
}

Log SimulatedGround::log_of(const std::string& drone, RunningPtr running)
{
    return [this, drone, running = std::move(running)](LogLevel, const std::string& text) {
        trace_.line(drone, text);
        if (text.starts_with("the network side threw"))
            std::abort();  // a crash prints its seed
        if (running && text == "started")
            took_name(drone, running);
        else if (running && text == "stopped")
            running->stopped = true;
        if (running_.contains(drone))
            links_.logged(drone, text, world_.now());
    };
}

void SimulatedGround::live(const std::string& name, EmbeddedDrone& embedded, const RunningPtr& running)
{
    const std::shared_ptr<void> gone(nullptr, [running](void*) { running->drone = nullptr; });
    Drone& drone = embedded.drone();
    if (name == mixtures::source)
        source(
            drone,
            [this, running](std::int64_t us, std::int64_t sequence, std::int64_t number) {
                if (has(mixtures::fault::ends))
                    captures_[{us, sequence}] = {running->epoch, number};
            },
            has(mixtures::fault::bodies) ? [this] { return body_size(); } : std::function<std::size_t()>());
    else if (name == mixtures::forker)
        fork(drone);
    else if (name == mixtures::joiner)
        pair(drone);
    else
        watched_worker(drone, [this, name](const Event& event) { on_work(name, event); });
    drone.on_start([&] {
        running->drone = &drone;
        running->epoch = drone.status().epoch;
        running->ready = true;
    });
    embedded.run();
}

std::vector<std::string> SimulatedGround::answering() const
{
    auto names = topology_.drones();
    std::erase_if(names, [&](const auto& drone) {
        return killed_.contains(drone) || !running_.contains(drone) || frozen_.contains(drone);
    });
    return names;
}

Statuses SimulatedGround::statuses()
{
    Statuses statuses;
    for (const auto& name : answering())
        if (auto* const drone = running_.at(name)->drone)
            statuses[name] = drone->status();
    return statuses;
}

mixtures::Settings SimulatedGround::settings()
{
    return calls_.keep("get of many", [this] { return mixtures::settings_of(*application_, answering()); });
}

std::int64_t SimulatedGround::count()
{
    return calls_.keep("get", [this] { return application_->get(mixtures::source, {"count"}).at("count"); });
}

std::vector<std::string> SimulatedGround::complaints()
{
    auto all = links_.take_problems();
    for (auto* const seen : {&wrong_ages_, &wrong_ends_, &wrong_owners_, &wrong_bodies_})
        std::ranges::move(std::exchange(*seen, {}), std::back_inserter(all));
    for (auto* const more : {&calls_, &waits_, &impatient_calls_, &replaces_})
        std::ranges::move(more->take_problems(), std::back_inserter(all));
    return all;
}

std::vector<std::string> SimulatedGround::fallen()
{
    auto fallen = std::exchange(fallen_, {});
    for (const auto& [drone, running] : running_)
        if (!killed_.contains(drone) && running->process->dead)
            fallen.push_back(drone + " ended by itself: " + running->process->failure);
    return fallen;
}

std::vector<std::string> SimulatedGround::end()
{
    std::vector<std::string> left;
    for (const auto& [drone, running] : running_) {
        links_.broken(drone, world_.now());
        calls_.keep("stop", [&] { application_->stop(drone); });
        const auto process = running->process;
        for (const auto last = world_.now() + 5s; !process->dead && world_.now() < last;)
            world_.sleep(1ms);
        if (!process->dead || !process->failure.empty())
            left.push_back(drone + (process->dead ? " ended with " + process->failure : " still runs") + " after stop");
    }
    for (const auto& drone : application_->remembered())
        if (std::ranges::count(topology_.drones(), drone) > 0)
            left.push_back(drone + " is still remembered");
    return left;
}

// --- the collector ---

/// Epoch of the source's run, and number in it.
std::pair<std::int64_t, std::int64_t> SimulatedGround::place_of(const Identity& identity) const
{
    const auto found = captures_.find({identity.captured_us, identity.sequence});
    return found == captures_.end() ? std::pair(identity.epoch, identity.sequence) : found->second;
}

void SimulatedGround::take(const Event& event, bool failed)
{
    check_age(event);
    if (const auto wrong = failed ? std::nullopt : wrong_body(event))
        wrong_bodies_.push_back(*wrong);
    auto outcome = mixtures::outcome_of(event, failed);
    std::tie(outcome.epoch, outcome.sequence) = place_of(event.identity);
    collected_.came.push_back(std::move(outcome));
    trace_.line("collector", std::to_string(event.identity.sequence) + ": " + to_text(collected_.came.back()));
}

/// ages: an event has its correct age, or none.
void SimulatedGround::check_age(const Event& event)
{
    const auto error = age_error();
    if (!has(mixtures::fault::clocks) || !error || event.identity.captured_us == 0)
        return;
    const std::chrono::microseconds captured(event.identity.captured_us);
    const auto age = world_.age() - world_.age_at(machine_of(mixtures::source), captured - when_it_began);
    if (std::chrono::abs(event.age() - age) > *error + age / 1000)
        wrong_ages_.push_back("ages: event " + std::to_string(event.identity.sequence) + " says that it is "
                              + std::to_string(event.age().count()) + " us old; it is "
                              + std::to_string(std::chrono::floor<std::chrono::microseconds>(age).count()) + " us old");
}

/// Collects results and exceptions.
std::vector<Endpoint> SimulatedGround::ends() const
{
    std::vector<Endpoint> ends;
    for (const auto& drone : topology_.stages.back().drones)
        ends.push_back({drone, Topology::output_of(drone)});
    return ends;
}

void SimulatedGround::collect()
{
    Application application(application_named("collector")), hearing(application_named(mixtures::hearer));
    const auto results = application.collect(ends(), {.ordered = topology_.ordered});
    const auto exceptions = hearing.exceptions(topology_.drones());
    for (collected_.begun = true; !collected_.ending;) {
        if (const auto result = waits_.keep("next", [&] { return results->next(turn_time); }))
            take(*result, false);
        const auto exception = exceptions->next(results->ended() ? turn_time : 0ms);  // one of the two waits
        if (exception && exception->identity.sequence > 0)
            take(*exception, true);
        collected_.counts = results->counts();
        collected_.ended = results->ended();
    }
}

void SimulatedGround::collect_branch()
{
    for (branch_.emplace(application_named("branch")); !ending_;)
        if (!branch_->take(turn_time))
            world_.sleep(1ms);  // at its end it does not wait
    branch_.reset();
}

std::vector<mixtures::Received> SimulatedGround::received()
{
    const auto place = [this](const Identity& identity, std::int64_t) { return place_of(identity); };
    return branch_ ? branch_->received(place) : std::vector<mixtures::Received>{};
}

}  // namespace hive::simulation
