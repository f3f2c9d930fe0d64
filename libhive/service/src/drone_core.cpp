// The user thread of a drone: start, loop, callbacks, exceptions.
#include "drone_core.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <iostream>
#include <unistd.h>

namespace hive {

using protocol::PacketType;

namespace {

constexpr auto never = std::chrono::steady_clock::time_point::max();

}  // namespace

DroneCore::DroneCore(DroneProgram program, DroneSettings settings)
    : program_(std::move(program)), settings_(std::move(settings)), epoch_(event::wall_us())
{
    interface.kind = program_.kind;
    interface.summary = program_.summary;
    interface.version = HIVE_VERSION;
    interface.stateful = program_.stateful;
}

/// A start that failed may have left the network side serving: it ends before what it uses.
DroneCore::~DroneCore()
{
    if (module_)
        module_->end();
}

std::size_t DroneCore::add_output(Port port, Encoder encoder)
{
    interface.outputs.push_back(std::move(port));
    outputs_.push_back(&slots_.emplace_back());
    outputs_.back()->encoder = std::move(encoder);
    return outputs_.size() - 1;
}

void DroneCore::run()
{
    interface.parameters = parameters.declared();
    if (settings_.describe) {
        std::cout << to_json(interface).dump(2) << std::endl;
        return;
    }
    started_ = Clock::now();
    prepare();
    loop();
    last_status_ = status();
    module_->end();  // not reset(): what still runs on the network side uses module_
    log("ended");
}

void DroneCore::prepare()
{
    home_.emplace(event::default_home());
    claim_.emplace(*home_, settings_.name);
    module_ = std::make_unique<event::Module>(event::Module::Options{
        .self = {.name = settings_.name, .kind = interface.kind, .epoch = epoch_, .pid = ::getpid()},
        .limits = {},
        .timing = {},
        .log = [this](const std::string& text) { log(text); }});
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        outputs_[i]->outlet =
            &module_->add_outlet(interface.outputs[i], PacketType::event, std::move(outputs_[i]->encoder));
    exceptions_ = &module_->add_outlet({"exceptions", "application/x-hive-exception", "what this drone's code threw"},
                                       PacketType::exception);
    module_->on_demand = [this] { mailbox_.nudge(); };
    module_->on_failed = [this](const event::EmissionPtr& event) {
        const int attempts = event->event().identity.attempt;
        report(Errc::abandoned,
               "given up after " + std::to_string(attempts) + (attempts == 1 ? " attempt" : " attempts"),
               &event->event());
    };
    module_->on_not_encoded = [this](const event::EmissionPtr& event, const Error& problem) {
        report(problem.code(), problem.what(), &event->event());
    };
    add_handlers();
    const Json state = left_state(*home_);
    board_.policy =
        settings_.policy ? *settings_.policy : from_token<ExceptionPolicy>(state.value("policy", "skip"), "policy");
    Json values = still_taken(state.value("parameters", Json::object()));
    values.update(parameters.checked(settings_.parameters));
    parameters.apply(values, [] {});
    on_start();
    on_change();
    parameters.read_back();
    set_state(State::idle);
    module_->start();
    module_->call([&] {
        module_->on_signal([this](int) { end(true); });
        module_->listen(home_->address(settings_.name));
        for (const auto& address : settings_.listen)
            log("listening at " + to_text(module_->listen(transport::parse_address(address))));
        restore(state);
        remember();
    });
    log("started");
}

std::optional<Json> DroneCore::given(const std::string& parameter) const
{
    if (settings_.parameters.contains(parameter))
        return settings_.parameters[parameter];
    if (settings_.describe)
        return std::nullopt;  // without a home
    const Json told = left_state(event::Home(event::default_home())).value("parameters", Json::object());
    return told.contains(parameter) ? std::optional(told[parameter]) : std::nullopt;
}

Json DroneCore::status()
{
    if (stopping_ && !last_status_.is_null())
        return last_status_;
    Json now;
    module_->call([&] { now = status_now(); });
    return now;
}

void DroneCore::loop()
{
    next_step_ = Clock::now();
    while (!stopping_) {
        auto item = module_->next(mailbox_, next_deadline());
        if (item) {
            if (auto* command = std::get_if<event::Mailbox::Command>(&*item))
                (*command)();
            else
                deliver(std::move(std::get<Event>(*item)));
        }
        work_on_sets();
        if (main && !halted_ && !stopping_ && (!item || Clock::now() >= next_step_))
            step();
    }
    set_state(State::stopping);
}

DroneCore::Clock::time_point DroneCore::next_deadline() const
{
    auto first = main && !halted_ ? next_step_ : never;
    for (const auto& matching : matchings)
        first = std::min(first, matching.matcher.deadline().value_or(never));
    return first;
}

void DroneCore::step()
{
    begin_work("main");
    try {
        next_step_ = Clock::now() + main();
    } catch (const CaptureFailed& error) {
        failed({}, error.code(), error.what(), &error.lost());
    } catch (const Error& error) {
        failed({}, error.code(), error.what());
    } catch (const std::exception& error) {
        failed({}, Errc::failed, error.what());
    }
    end_work();
}

void DroneCore::deliver(Event&& event)
{
    for (auto& matching : matchings)
        if (const auto* input = matching.input(event.input))
            return to_partners(std::move(event), matching, *input);
    Set set;
    set.push_back(std::move(event));
    const auto callback = [&] {
        require_type(set.front());
        callbacks.at(set.front().input)(set.front());
    };
    if (work(set, callback))
        processed(set);
}  // the receipt goes with the set: the next one is asked for, unless the drone has halted

/// @return  whether the callback came to its end
bool DroneCore::work(const Set& set, const std::function<void()>& callback)
{
    begin_work(set.front().input);
    current_ = &set;
    current_since_ = Clock::now();
    for (auto* slot : outputs_)
        slot->part = 0;
    bool done = false;
    try {
        callback();
        done = true;
    } catch (const Error& error) {
        failed(set, error.code(), error.what());
    } catch (const std::exception& error) {
        failed(set, Errc::failed, error.what());
    } catch (...) {
        failed(set, Errc::failed, "something that is no exception was thrown");
    }
    current_ = nullptr;
    end_work();
    return done;
}

void DroneCore::require_type(const Event& event) const
{
    const auto* input = interface.input(event.input);
    if (!types_fit(event.type, input->type))
        throw Error(Errc::type_mismatch, event.sender + "." + event.output + " sent " + event.type + ", but "
                                             + event.input + " takes " + input->type);
}

void DroneCore::processed(const Set& set)
{
    const std::lock_guard lock(board_mutex_);
    board_.processed += static_cast<std::int64_t>(set.size());
}

/// @param set   empty: it was main that failed
/// @param lost  then what it could not give, if that has an identity
void DroneCore::failed(const Set& set, Errc code, const std::string& text, const Event* lost)
{
    report(code, text, set.empty() ? lost : &set.front());
    if (set.empty())
        next_step_ = Clock::now() + std::chrono::milliseconds(100);  // a main that keeps failing must not spin
    bool halt = false;
    {
        const std::lock_guard lock(board_mutex_);
        halt = board_.policy == ExceptionPolicy::halt;
        for (const auto& event : set) {
            ++board_.abandoned;
            ++board_.abandoned_at[event.input];
        }
    }
    if (halt) {
        halted_ = true;
        module_->halt(true);
    }
}

void DroneCore::report(Errc code, const std::string& text, const Event* cause)
{
    Event event;
    event.identity = cause ? cause->identity
                           : Identity{.source = settings_.name,
                                      .epoch = epoch_,
                                      .captured_us = event::wall_us(),
                                      .monotonic_us = event::steady_us(),
                                      .hops = {}};
    event.sender = settings_.name;
    event.kind = interface.kind;
    event.output = "exceptions";
    event.type = "application/x-hive-exception";
    {
        const std::lock_guard lock(board_mutex_);
        event.header = {{"code", info(code).token},
                        {"text", text.substr(0, 4000)},
                        {"policy", token(board_.policy)},
                        {"input", cause ? cause->input : ""}};
        board_.last_exception = event.header;
        board_.last_exception["time_us"] = event::wall_us();
        board_.last_exception["source"] = event.identity.source;
        board_.last_exception["seq"] = event.identity.sequence;
    }
    log(std::string("exception: ") + std::string(info(code).token) + ": " + text);
    module_->post([this, emission = std::make_shared<const event::Emission>(std::move(event))] {
        module_->emit(*exceptions_, emission);
    });
}

void DroneCore::set_state(State state)
{
    const std::lock_guard lock(board_mutex_);
    board_.state = state;
}

void DroneCore::begin_work(const std::string& what)
{
    const std::lock_guard lock(board_mutex_);
    board_.state = State::busy;
    board_.callback = what;
    board_.busy_since = Clock::now();
}

void DroneCore::end_work()
{
    const std::lock_guard lock(board_mutex_);
    board_.busy_us += event::microseconds(Clock::now() - board_.busy_since);
    board_.state = halted_ ? State::halted : State::idle;
    board_.callback.clear();
}

void DroneCore::apply(const Json& values) { parameters.apply(values, on_change); }

void DroneCore::wake()
{
    mailbox_.nudge();
    if (module_)
        module_->loop().interrupt();
}

void DroneCore::condition(const std::string& text)
{
    const std::lock_guard lock(board_mutex_);
    if (board_.condition != text && !text.empty())
        log("condition: " + text);
    board_.condition = text;
}

void DroneCore::log(const std::string& text) const { spdlog::info("{}: {}", settings_.name, text); }

}  // namespace hive
