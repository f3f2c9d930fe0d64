// The functions that create, declare and run a drone.
#include "declared.hpp"
#include "drone_object.hpp"
#include "texts.hpp"

#include <algorithm>
#include <climits>

using namespace hive;
using namespace hive::c;

namespace {

constexpr int64_t longest_wait_us = 24LL * 3600 * 1'000'000;

DroneProgram program_of(const char* kind, const char* summary, const Options& options)
{
    return {text_of(kind, "the kind"), text_or_empty(summary), options.flag("stateful")};
}

EmbeddedOptions embedded_of(const Options& options)
{
    EmbeddedOptions embedded;
    embedded.name = options.text("name");
    embedded.listen = options.texts("listen");
    embedded.advertise = options.texts("advertise");
    embedded.insecure = options.flag("insecure");
    embedded.key = options.text("key");
    embedded.no_announce = options.flag("no_announce");
    embedded.remote_operator = options.flag("remote_operator");
    embedded.halted = options.flag("halted");
    embedded.parameters = options.object("parameters");
    embedded.connect = options.texts("connect");
    embedded.signals = options.flag("signals");
    embedded.ends_process = options.flag("ends_process");
    if (const auto policy = options.text("on_exception"); policy == "skip" || policy == "halt")
        embedded.policy = policy == "skip" ? ExceptionPolicy::skip : ExceptionPolicy::halt;
    else if (!policy.empty())
        throw Error(Errc::invalid_argument, "option on_exception is neither skip nor halt");
    return embedded;
}

Reason reason_of(const std::string& word)
{
    for (int i = 0; i <= static_cast<int>(Reason::watched); ++i)
        if (token(static_cast<Reason>(i)) == word)
            return static_cast<Reason>(i);
    throw Error(Errc::invalid_argument, in_quotes(word) + " is not one of the reasons why nothing moves");
}

LogLevel level_of(const std::string& word)
{
    const auto* found = std::ranges::find(log_levels, word);
    if (found == log_levels.end())
        throw Error(Errc::invalid_argument, in_quotes(word) + " is not a log level: debug, info, warning or error");
    return static_cast<LogLevel>(found - log_levels.begin());
}

std::vector<MatchedInput> matched_inputs(const char* text, DroneObject& drone, hive_event_callback check, void* user)
{
    const Json list = json_of(required(text, "the inputs"), "the inputs");
    if (!list.is_array() || list.size() < 2)
        throw Error(Errc::invalid_argument, "the inputs are not an array of two or more");
    std::vector<MatchedInput> inputs;
    for (const auto& item : list) {
        const Options input(to_text(item).c_str(), {"name", "type", "help"});
        inputs.push_back({input.text("name"), input.text("type"), input.text("help")});
        if (check)
            inputs.back().check = [&drone, check, user](const Event& event) {
                const Lent lent(event);
                drone.call([&] { return check(user, *lent.data()); });
            };
    }
    return inputs;
}

/// Each is also checked against those before it.
void require_inputs(Interface declared, const std::vector<MatchedInput>& inputs)
{
    for (const auto& input : inputs) {
        require_input(declared, input.name, input.type);
        declared.inputs.push_back({input.name, input.type, input.help});
    }
}

/// Runs with the drone of a handle, from any thread.
template <class Function>
hive_code with_drone(const hive_drone* drone, Function&& function)
{
    return guarded([&] { function(get<DroneObject>(drone)->open()->drone()); });
}

/// Declares a callback, which then runs on the drone's thread.
template <class Callback, class Declare>
hive_code declare(hive_drone* drone, Callback* callback, Declare&& function)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        required(callback, "the callback");
        const auto open = object->declaring();
        function(open->drone(), object.get());
    });
}

/// Runs or starts the drone on this thread.
hive_code begin(hive_drone* drone, void (EmbeddedDrone::*run)())
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        object->as_user_thread([&](EmbeddedDrone& embedded) {
            object->begin();
            (embedded.*run)();
        });
    });
}

}  // namespace

hive_code hive_drone_new(const char* kind, const char* summary, const char* options, hive_drone** drone)
{
    return guarded([&] {
        required(drone, "the place for the drone");
        const Options read(options, {"name", "stateful", "parameters", "connect", "on_exception", "halted", "listen",
                                     "advertise", "key", "insecure", "no_announce", "remote_operator", "signals",
                                     "ends_process"});
        *drone = give(std::make_shared<DroneObject>(program_of(kind, summary, read), embedded_of(read)));
    });
}

hive_code hive_drone_from_arguments(const char* kind, const char* summary, const char* options, int argc,
                                    const char* const* argv, hive_drone** drone, int* exit_code)
{
    return guarded([&] {
        *required(drone, "the place for the drone") = nullptr;
        required(exit_code, "the place for the exit code");
        for (int i = 0; i < argc; ++i)
            required(required(argv, "argv")[i], "a word of argv");
        const auto program = program_of(kind, summary, Options(options, {"stateful"}));
        if (argc < 1)
            throw Error(Errc::invalid_argument, "argv has not even the name of the program");
        if (auto made = EmbeddedDrone::from_command_line(argc, argv, program, *exit_code))
            *drone = give(std::make_shared<DroneObject>(std::move(made)));
    });
}

int hive_stack_descriptor(void) { return foreign_stack_descriptor(); }

hive_code hive_drone_on_log(hive_drone* drone, hive_log_callback callback, void* user)
{
    return guarded([&] {
        const auto write = [callback, user](LogLevel, const char* line) { callback(user, line); };
        get<DroneObject>(drone)->log().set(callback ? LogSink::Write(write) : LogSink::Write());
    });
}

hive_code hive_drone_on_leveled_log(hive_drone* drone, hive_leveled_log_callback callback, void* user)
{
    return guarded([&] {
        const auto write = [callback, user](LogLevel level, const char* line) {
            callback(user, log_levels.at(static_cast<std::size_t>(level)).data(), line);
        };
        get<DroneObject>(drone)->log().set(callback ? LogSink::Write(write) : LogSink::Write());
    });
}

hive_code hive_drone_name(const hive_drone* drone, char** name)
{
    return guarded([&] { give_text(get<DroneObject>(drone)->open()->name(), name); });
}

hive_code hive_drone_given(hive_drone* drone, const char* parameter, char** json, bool* remembered)
{
    return guarded([&] {
        const auto open = get<DroneObject>(drone)->declaring();
        const auto name = text_of(parameter, "the parameter");
        const auto value = open->drone().given(name);
        *required(json, "the place for the value") = nullptr;
        if (remembered)
            *remembered = open->drone().remembered(name);
        if (value)
            give_json(*value, json);
    });
}

hive_code hive_drone_output(hive_drone* drone, const char* name, const char* type, const char* help,
                            hive_output** output)
{
    return guarded([&] {
        required(output, "the place for the output");
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        const auto named = text_of(name, "the name"), types = text_of(type, "the type");
        require_output(open->interface(), named, types);
        const auto made = open->drone().output(named, types, text_or_empty(help));
        *output = give(std::make_shared<OutputObject>(object, made));
    });
}

hive_code hive_drone_on_event(hive_drone* drone, const char* input, const char* type, const char* help,
                              hive_event_callback callback, void* user)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        required(callback, "the callback");
        const auto call = [raw = object.get(), callback, user](const Event& event) {
            const Lent lent(event);
            raw->call([&] { return callback(user, *lent.data()); });
        };
        const auto open = object->declaring();
        const auto named = text_of(input, "the input"), types = text_of(type, "the type");
        require_input(open->interface(), named, types);
        open->drone().on_event(named, types, call, text_or_empty(help));
    });
}

hive_code hive_drone_on_matched(hive_drone* drone, const char* inputs, const char* match, hive_set_callback callback,
                                hive_event_callback check, void* user, hive_matching** matching)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        required(callback, "the callback");
        const auto call = [raw = object.get(), callback, user](const std::vector<Event>& events) {
            const Lent lent(events);
            raw->call([&] { return callback(user, lent.data(), lent.size()); });
        };
        const auto open = object->declaring();
        auto wanted = matched_inputs(inputs, *object, check, user);
        require_inputs(open->interface(), wanted);
        const auto made = open->drone().on_matched(std::move(wanted), match_of(match), call);
        if (matching)
            *matching = give(std::make_shared<MatchingObject>(object, made));
    });
}

hive_code hive_matching_rule(hive_matching* matching, const char* match)
{
    return guarded([&] {
        const auto object = get<MatchingObject>(matching);
        const auto open = object->drone->on_user_thread();
        object->matching.rule(match_of(match));
    });
}

hive_code hive_drone_on_change(hive_drone* drone, hive_callback callback, void* user)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        object->on_change(callback, user);
    });
}

hive_code hive_drone_on_start(hive_drone* drone, hive_callback callback, void* user)
{
    return declare(drone, callback, [&](Drone& open, DroneObject* raw) {
        open.on_start([raw, callback, user] { raw->call([&] { return callback(user); }); });
    });
}

hive_code hive_drone_on_end(hive_drone* drone, hive_end_callback callback, void* user)
{
    return declare(drone, callback, [&](Drone& open, DroneObject* raw) {
        open.on_end([raw, callback, user](const std::string& text) {
            raw->call([&] { return callback(user, text.c_str()); });
        });
    });
}

hive_code hive_drone_main(hive_drone* drone, hive_main_callback callback, void* user)
{
    return declare(drone, callback, [&](Drone& open, DroneObject* raw) {
        open.main([raw, callback, user] {
            int64_t wait_us = 0;
            raw->call([&] { return callback(user, &wait_us); });
            return std::chrono::microseconds(std::clamp<int64_t>(wait_us, 0, longest_wait_us));
        });
    });
}

hive_code hive_drone_describe(const hive_drone* drone, char** json, size_t* length)
{
    return guarded([&] { give_json(to_json(get<DroneObject>(drone)->open()->interface()), json, length); });
}

hive_code hive_drone_run(hive_drone* drone) { return begin(drone, &EmbeddedDrone::run); }

hive_code hive_drone_start(hive_drone* drone) { return begin(drone, &EmbeddedDrone::start); }

hive_code hive_drone_step(hive_drone* drone, int64_t time_ms, bool* goes_on)
{
    return guarded([&] {
        required(goes_on, "the place for the answer");
        get<DroneObject>(drone)->as_user_thread(
            [&](EmbeddedDrone& embedded) { *goes_on = embedded.step(timeout_of(time_ms)); });
    });
}

hive_code hive_drone_end(hive_drone* drone)
{
    return guarded([&] { get<DroneObject>(drone)->as_user_thread([](EmbeddedDrone& embedded) { embedded.end(); }); });
}

hive_code hive_drone_wake(hive_drone* drone)
{
    return with_drone(drone, [](Drone& open) { open.wake(); });
}

hive_code hive_drone_stop(hive_drone* drone)
{
    return with_drone(drone, [](Drone& open) { open.stop(); });
}

hive_code hive_drone_condition(hive_drone* drone, const char* text, const char* reason)
{
    return with_drone(drone,
                      [&](Drone& open) { open.condition(text_or_empty(text), reason_of(text_or_empty(reason))); });
}

hive_code hive_drone_source_events(hive_drone* drone, int64_t events)
{
    return with_drone(drone, [&](Drone& open) {
        if (events < 0)
            throw Error(Errc::invalid_argument, "events must be 0 or more");
        open.source_events(events);
    });
}

hive_code hive_drone_report(hive_drone* drone, hive_code code, const char* text)
{
    return with_drone(drone, [&](Drone& open) { open.report(errc_of(code), text_or_empty(text)); });
}

hive_code hive_drone_log(hive_drone* drone, const char* text)
{
    return with_drone(drone, [&](Drone& open) { open.log(text_or_empty(text)); });
}

hive_code hive_drone_log_at(hive_drone* drone, const char* level, const char* text)
{
    return with_drone(drone,
                      [&](Drone& open) { open.log(text_or_empty(text), level_of(text_of(level, "the level"))); });
}

hive_code hive_drone_stopping(const hive_drone* drone, bool* stopping)
{
    return with_drone(drone, [&](Drone& open) { *required(stopping, "the place for the answer") = open.stopping(); });
}

hive_code hive_drone_status(hive_drone* drone, char** json, size_t* length)
{
    return guarded([&] {
        const auto object = get<DroneObject>(drone);
        const auto open = object->on_user_thread();
        give_json(to_json(open->drone().status()), json, length);
    });
}
