// The functions of applications.
#include "application_object.hpp"
#include "own_timeout.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive/process.hpp>
#include <hive/program.hpp>

#include <algorithm>

using namespace hive;
using namespace hive::c;

namespace {

using namespace std::chrono_literals;

Json answers_json(const std::vector<Answer>& answers)
{
    Json list = Json::array();
    for (const auto& answer : answers)
        if (const auto* error = error_of(answer.result))
            list.push_back({{"drone", answer.drone}, {"error", error_json(*error)}});
        else
            list.push_back({{"drone", answer.drone}, {"result", std::get<Json>(answer.result)}});
    return list;
}

Json answer_json(const StatusAnswer& answer)
{
    Json object{{"drone", answer.drone}, {"place", place_json(answer.place)}};
    if (const auto* error = error_of(answer.status))
        object["error"] = error_json(*error);
    else
        object["status"] = to_json(std::get<Status>(answer.status));
    return object;
}

const char* changed_text(SetResult::Changed changed)
{
    return changed == SetResult::Changed::all ? "all" : changed == SetResult::Changed::none ? "none" : "unclear";
}

/// The state of a drone as text: its own, or "gone", or "silent".
std::string state_of(Application& application, const std::string& name)
{
    if (name.find('@') == std::string::npos && !std::ranges::binary_search(application.drones(), name))
        return "gone";
    const auto answer = application.status(std::vector{name}).at(0);
    if (const auto* status = value_of(answer.status))
        return std::string(token(status->state));
    return std::get<Error>(answer.status).code() == Errc::timeout ? "silent" : "gone";
}

bool reached(const std::string& goal, const std::string& state)
{
    return goal == "running" ? state == "idle" || state == "busy" || state == "halted" : state == goal;
}

void require_goal(const std::string& goal)
{
    for (const char* known : {"running", "idle", "halted", "gone"})
        if (goal == known)
            return;
    throw Error(Errc::invalid_argument, "the state is running, idle, halted or gone, not " + in_quotes(goal));
}

Error late(const std::string& drone, const std::string& goal, const std::string& state)
{
    const auto kind = kind_by_name(drone);
    const auto advice = state != "gone" ? "allow more time, or see what it is busy with: hivectl ps"
                        : kind          ? "start it: " + start_command(*kind, drone)
                                        : "see what runs: hivectl ps";
    return {Errc::timeout,
            drone + " is not " + goal + " in the time allowed" + (state == "gone" ? "" : ", but " + state), advice};
}

}  // namespace

hive_code hive_default_home(char** path)
{
    return guarded([&] { give_text(default_home().string(), path); });
}

hive_code hive_application_new(const char* options, hive_application** application)
{
    return guarded([&] {
        required(application, "the place for the application");
        const Options read(options, {"name", "home", "timeout_ms", "key"});
        Application::Options made;
        made.name = read.text("name");
        made.home = read.text("home");
        made.key = read.text("key");
        made.cancelled = wait_is_cancelled;
        made.timeout = timeout_of(read.integer("timeout_ms", 0, made.timeout.count()));
        *application = give(std::make_shared<ApplicationObject>(std::move(made)));
    });
}

hive_code hive_application_close(hive_application* application)
{
    return guarded([&] { get<ApplicationObject>(application)->close(); });
}

hive_code hive_application_name(const hive_application* application, char** name)
{
    return guarded([&] { give_text(get<ApplicationObject>(application)->application_name(), name); });
}

hive_code hive_application_timeout(hive_application* application, int64_t timeout_ms)
{
    return guarded([&] { get<ApplicationObject>(application)->timeout(timeout_of(timeout_ms)); });
}

hive_code hive_application_drones(hive_application* application, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) { give_json(open.drones(), json, length); });
}

hive_code hive_application_remembered(hive_application* application, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) { give_json(open.remembered(), json, length); });
}

hive_code hive_application_find(hive_application* application, const char* pattern, char** json, size_t* length)
{
    return with_application(
        application, [&](Application& open) { give_json(open.find(text_of(pattern, "the pattern")), json, length); });
}

hive_code hive_application_describe(hive_application* application, const char* drone, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        give_json(to_json(open.describe(text_of(drone, "the drone"))), json, length);
    });
}

hive_code hive_application_status(hive_application* application, const char* drone, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        give_json(to_json(open.status(text_of(drone, "the drone"))), json, length);
    });
}

hive_code hive_application_status_all(hive_application* application, const char* drones, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        Json list = Json::array();
        for (const auto& answer : open.status(names_of(required(drones, "the drones"), "the drones")))
            list.push_back(answer_json(answer));
        give_json(list, json, length);
    });
}

/// Other threads are let in between two polls.
hive_code hive_application_wait(hive_application* application, const char* drone, const char* state, int64_t timeout_ms)
{
    return guarded([&] {
        const auto object = get<ApplicationObject>(application);
        const std::string name = text_of(drone, "the drone"), goal = text_of(state, "the state");
        require_goal(goal);
        const auto end = std::chrono::steady_clock::now() + timeout_of(timeout_ms);
        for (;;) {
            const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
            std::string found;
            object->with([&](Application& open) {
                const OwnTimeout looking(open, std::clamp<std::chrono::milliseconds>(left, 1ms, 1s), object->timeout());
                found = state_of(open, name);
            });
            if (reached(goal, found))
                return;
            if (left <= 0ms)
                throw late(name, goal, found);
            require_wait();
            object->rest(std::clamp<std::chrono::milliseconds>(left, 1ms, 20ms));
        }
    });
}

hive_code hive_application_connect(hive_application* application, const char* sender, const char* receiver,
                                   const char* options, char** ends)
{
    return with_application(application, [&](Application& open) {
        const auto connection = connection_of(object_of(options ? options : "{}", "the options"));
        const auto made = open.connect(open.endpoint(text_of(sender, "the sender")),
                                       open.endpoint(text_of(receiver, "the receiver")), connection);
        if (ends)
            give_json({{"sender", to_text(made.first)}, {"receiver", to_text(made.second)}}, ends);
    });
}

hive_code hive_application_disconnect(hive_application* application, const char* sender, const char* receiver)
{
    return with_application(application, [&](Application& open) {
        open.disconnect(open.endpoint(text_of(sender, "the sender")), open.endpoint(text_of(receiver, "the receiver")));
    });
}

hive_code hive_application_set(hive_application* application, const char* drone, const char* parameters, char** applied)
{
    return with_application(application, [&](Application& open) {
        const Json values = open.set(text_of(drone, "the drone"), object_of(parameters, "the parameters"));
        if (applied)
            give_json(values, applied);
    });
}

hive_code hive_application_set_all(hive_application* application, const char* drones, const char* parameters,
                                   hive_callback cancelled, void* user, char** result)
{
    return with_application(application, [&](Application& open) {
        const auto is_cancelled = [&] { return cancelled && cancelled(user) != HIVE_OK; };
        const auto set =
            open.set(names_of(drones, "the drones"), object_of(parameters, "the parameters"), is_cancelled);
        give_json({{"changed", changed_text(set.changed)}, {"answers", answers_json(set.answers)}}, result);
    });
}

hive_code hive_application_get(hive_application* application, const char* drone, const char* names, char** values)
{
    return with_application(application, [&](Application& open) {
        give_json(open.get(text_of(drone, "the drone"), names_of(names, "the names")), values);
    });
}

hive_code hive_application_get_all(hive_application* application, const char* drones, const char* names, char** answers)
{
    return with_application(application, [&](Application& open) {
        give_json(answers_json(open.get(names_of(drones, "the drones"), names_of(names, "the names"))), answers);
    });
}

hive_code hive_application_put(hive_application* application, const char* input, const char* header, size_t length,
                               const void* bytes, size_t size, const char* type)
{
    return with_application(application, [&](Application& open) {
        const auto* first = static_cast<const unsigned char*>(size > 0 ? required(bytes, "the bytes") : bytes);
        open.put(open.endpoint(text_of(input, "the input")), header_of(header, length),
                 Body(std::vector<unsigned char>(first, first + size)), text_of(type, "the type"));
    });
}

hive_code hive_application_halt(hive_application* application, const char* drone)
{
    return with_application(application, [&](Application& open) { open.halt(text_of(drone, "the drone")); });
}

hive_code hive_application_resume(hive_application* application, const char* drone)
{
    return with_application(application, [&](Application& open) { open.resume(text_of(drone, "the drone")); });
}

hive_code hive_application_stop(hive_application* application, const char* drone)
{
    return with_application(application, [&](Application& open) {
        reap_background_processes();  // drones that this process had started and stopped
        open.stop(text_of(drone, "the drone"));
    });
}

hive_code hive_application_exception_policy(hive_application* application, const char* drone, const char* policy)
{
    return with_application(application, [&](Application& open) {
        const auto word = text_of(policy, "the policy");
        if (word != "skip" && word != "halt")
            throw Error(Errc::invalid_argument, "the policy is skip or halt, not " + in_quotes(word));
        open.exception_policy(text_of(drone, "the drone"),
                              word == "skip" ? ExceptionPolicy::skip : ExceptionPolicy::halt);
    });
}
