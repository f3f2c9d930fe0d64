// The functions of swarms.
#include "application_object.hpp"
#include "texts.hpp"
#include "waiting.hpp"

#include <hive_swarm.h>

#include <hive/program.hpp>
#include <hive/swarm.hpp>
#include <hive/swarm_export.hpp>

#include <algorithm>
#include <atomic>
#include <exception>

using namespace hive;
using namespace hive::c;

namespace {

class SwarmObject final : public Object {
public:
    using Handle = hive_swarm;
    static constexpr const char* name = "hive_swarm";

    SwarmObject(std::shared_ptr<ApplicationObject> of, SwarmPlan file)
        : application(std::move(of)), plan(std::move(file))
    {
    }
    void released() override { closed = true; }

    const std::shared_ptr<ApplicationObject> application;
    const SwarmPlan plan;
    std::atomic<bool> closed = false;
};

template <class Function>
hive_code with_swarm(hive_swarm* handle, Function&& function)
{
    return guarded([&] {
        const auto object = get<SwarmObject>(handle);
        object->application->with([&](Application& open) {
            if (object->closed)
                throw Error(Errc::stopped, "the swarm is closed");
            Swarm swarm(open, object->plan);
            function(swarm, *object);
        });
    });
}

// --- JSON ---

Json mistakes_json(const std::vector<Mistake>& mistakes)
{
    Json list = Json::array();
    for (const auto& mistake : mistakes)
        list.push_back({{"line", mistake.line},
                        {"column", mistake.column},
                        {"at", mistake.at},
                        {"text", mistake.text},
                        {"advice", mistake.advice},
                        {"file", mistake.file}});
    return list;
}

Json step_json(const SwarmStep& step)
{
    using What = SwarmStep::What;
    Json json{{"step", token(step.what)}, {"drone", step.drone}, {"what", to_text(step)}};
    if (!step.values.empty()) {
        json["values"] = step.values;
        json["before"] = step.before;
    } else if (step.what == What::connect || step.what == What::disconnect) {
        json["sender"] = to_text(step.connection.from);
        json["receiver"] = to_text(step.connection.to);
        json["options"] = to_json(step.connection.options);
    }
    return json;
}

Json steps_json(const std::vector<SwarmStep>& steps)
{
    Json list = Json::array();
    std::ranges::transform(steps, std::back_inserter(list), step_json);
    return list;
}

Json failures_json(const std::vector<SwarmFailure>& failures)
{
    Json list = Json::array();
    for (const auto& failure : failures)
        list.push_back({{"drone", failure.drone}, {"error", error_json(failure.error)}});
    return list;
}

Json outcome_json(const SwarmOutcome& outcome)
{
    return {{"steps", steps_json(outcome.steps)},
            {"failures", failures_json(outcome.failures)},
            {"remains", failures_json(outcome.remains)}};
}

// --- the file ---

SwarmReading reading_of(const char* text, const char* options)
{
    const Options given(options, {"timeout_ms", "form_only", "folder", "variables"});
    const auto file = text_of(text, "the swarm file");
    SwarmContext context;
    if (const auto folder = given.text("folder"); !folder.empty())
        context.folder = folder;
    const auto variables = given.object("variables");
    for (const auto& [name, value] : variables.items())
        context.variables[name] = value.is_string() ? value.get<std::string>() : to_text(value);
    return given.flag("form_only") ? read_swarm(file, {}, context)
                                   : check_swarm(file, timeout_of(given.integer("timeout_ms", 0, 10'000)), context);
}

void require_good(const std::vector<Mistake>& mistakes)
{
    if (mistakes.empty())
        return;
    const auto& first = mistakes.front();
    std::string text = (first.file.empty() ? "" : first.file + ":") + std::to_string(first.line) + ":"
                       + std::to_string(first.column) + ": " + first.text;
    if (const auto more = mistakes.size() - 1; more > 0)
        text += " (and " + std::to_string(more) + (more == 1 ? " more mistake)" : " more mistakes)");
    throw Error(Errc::invalid_argument, text, first.advice);
}

// --- progress and cancellation ---

/// A caller cancels by the callback of hive_on_wait, or by the result of the progress callback.
class Company {
public:
    Company(hive_progress_callback progress, void* user) : progress_(progress), user_(user) {}

    SwarmWatch watch()
    {
        return {.on_progress = [this](std::size_t done, std::size_t all,
                                      const std::string& what) { tell(done, all, what); },
                .cancelled = [this] { return undoable_.is_cancelled() || refused_; }};
    }

private:
    /// Polls for cancellation first, so that an earlier signal does not surface inside a callback in another language.
    void tell(std::size_t done, std::size_t all, const std::string& what)
    {
        if (progress_ && !undoable_.is_cancelled())
            refused_ = progress_(user_, done, all, what.c_str()) != HIVE_OK || refused_;
    }

    Undoable undoable_;
    hive_progress_callback progress_;
    void* user_;
    bool refused_ = false;
};

/// The callback for messages while a swarm is supervised, and its cancellation.
class Listener {
public:
    Listener(hive_told_callback told, void* user, SwarmObject& swarm) : told_(told), user_(user), swarm_(swarm) {}

    void hear(const std::string& text)
    try {
        if (undoable_.is_cancelled() || refused_)
            return;
        forget_error();
        require_done(told_(user_, text.c_str()));
    } catch (const Error&) {
        refused_ = std::current_exception();
    }

    bool leaves() { return undoable_.is_cancelled() || refused_ || swarm_.closed || swarm_.application->is_closing(); }

    [[noreturn]] void tell_why() const
    {
        if (refused_)
            std::rethrow_exception(refused_);
        throw Error(Errc::stopped, "stays with " + swarm_.plan.name + " no longer");
    }

private:
    Undoable undoable_;
    hive_told_callback told_;
    void* user_;
    SwarmObject& swarm_;
    std::exception_ptr refused_;
};

/// The drones of the swarm with that name, or all running ones.
std::vector<std::string> drones_meant(Application& application, const std::vector<SwarmPlan>& plans,
                                      const std::string& name)
{
    const auto plan = std::ranges::find(plans, name, &SwarmPlan::name);
    if (plan == plans.end())
        return application.drones();
    std::vector<std::string> names;
    std::ranges::transform(plan->drones, std::back_inserter(names), &SwarmDrone::name);
    return names;
}

}  // namespace

hive_code hive_swarm_check(const char* text, const char* options, char** json, size_t* length)
{
    return guarded([&] {
        const auto reading = reading_of(text, options);
        give_json({{"swarm", reading.plan.name},
                   {"mistakes", mistakes_json(reading.mistakes)},
                   {"notes", mistakes_json(reading.notes)}},
                  json, length);
    });
}

hive_code hive_swarm_schema(char** json, size_t* length)
{
    return guarded([&] { give_text(std::string(swarm_schema()), json, length); });
}

hive_code hive_swarm_open(hive_application* application, const char* text, const char* options, hive_swarm** swarm)
{
    return guarded([&] {
        required(swarm, "the place for the swarm");
        auto object = get<ApplicationObject>(application);
        object->with([](Application&) {});
        auto reading = reading_of(text, options);
        require_good(reading.mistakes);
        *swarm = give(std::make_shared<SwarmObject>(std::move(object), std::move(reading.plan)));
    });
}

hive_code hive_swarm_close(hive_swarm* swarm)
{
    return guarded([&] { get<SwarmObject>(swarm)->closed = true; });
}

hive_code hive_swarm_export(hive_swarm* swarm, const char* form, const char* options, char** json, size_t* length)
{
    return with_swarm(swarm, [&](Swarm& open, SwarmObject&) {
        const Options given(options, {"programs", "image"});
        ExportOptions wanted{.interface_of = [](const std::string& kind) { return interface_of(kind); }};
        for (const auto& [field, place] : {std::pair{"programs", &wanted.programs}, {"image", &wanted.image}})
            if (const auto text = given.text(field); !text.empty())
                *place = text;
        Json files = Json::array();
        for (const auto& file : export_swarm(open.plan(), text_of(form, "the form"), wanted))
            files.push_back({{"name", file.name}, {"text", file.text}, {"program", file.is_program}});
        give_json(files, json, length);
    });
}

hive_code hive_swarm_differences(hive_swarm* swarm, char** json, size_t* length)
{
    return with_swarm(swarm,
                      [&](Swarm& open, SwarmObject&) { give_json(steps_json(open.differences()), json, length); });
}

hive_code hive_swarm_up(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user, char** json,
                        size_t* length)
{
    return with_swarm(swarm, [&](Swarm& open, SwarmObject&) {
        required(json, "the place for the outcome");
        Company company(progress, user);
        give_json(outcome_json(open.up(timeout_of(timeout_ms), company.watch())), json, length);
    });
}

hive_code hive_swarm_down(hive_swarm* swarm, int64_t timeout_ms, hive_progress_callback progress, void* user,
                          char** json, size_t* length)
{
    return with_swarm(swarm, [&](Swarm& open, SwarmObject&) {
        required(json, "the place for the outcome");
        Company company(progress, user);
        give_json(outcome_json(open.down(timeout_of(timeout_ms), company.watch())), json, length);
    });
}

hive_code hive_swarm_stay(hive_swarm* swarm, hive_told_callback told, void* user)
{
    return with_swarm(swarm, [&](Swarm& open, SwarmObject& object) {
        Listener listener(required(told, "the callback"), user, object);
        open.stay([&](const std::string& text) { listener.hear(text); },
                  {.on_progress = {}, .cancelled = [&] { return listener.leaves(); }});
        listener.tell_why();
    });
}

hive_code hive_swarm_remembered(hive_application* application, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        Json list = Json::array();
        for (const auto& plan : Swarm::remembered(open))
            list.push_back({{"swarm", plan.name}, {"text", to_text(plan)}});
        give_json(list, json, length);
    });
}

hive_code hive_swarm_running(hive_application* application, const char* swarm, const char* drones, char** text,
                             size_t* length)
{
    return with_application(application, [&](Application& open) {
        const auto plans = Swarm::remembered(open);
        const std::string name = swarm ? swarm : plans.size() == 1 ? plans.front().name : "swarm";
        const auto names = drones ? names_of(drones, "the drones") : drones_meant(open, plans, name);
        give_text(to_text(Swarm::running(open, name, names)), text, length);
    });
}
