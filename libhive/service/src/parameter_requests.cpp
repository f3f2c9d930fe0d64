// Reads parameters at once, and sets them between two callbacks.
#include "parameter_requests.hpp"

#include <algorithm>

namespace hive::service {

using event::Clock;
using event::Incoming;

namespace {

constexpr std::chrono::milliseconds most_patience = std::chrono::hours(24);  ///< for a `set`, whatever its deadline
constexpr int default_deadline_ms = 5000;

Clock::time_point deadline_of(const Fields& fields)
{
    const std::chrono::milliseconds told(fields.integer_or("deadline_ms", 0, max_json_integer, default_deadline_ms));
    return Clock::now() + std::min(most_patience, told);
}

/// What the answer says when the drone's code threw: it understood, and said no.
Error refusal(const Error& error)
{
    return {error.code() == Errc::failed ? Errc::refused : error.code(), error.what()};
}

}  // namespace

void ParameterRequests::on_get(const Incoming& incoming) const
{
    const Fields fields(incoming.header, "get");
    std::vector<std::string> names;
    if (fields.has("names"))
        for (const auto& name : fields.array("names")) {
            if (!name.is_string())
                throw Error(Errc::malformed, "get: \"names\" must be an array of texts");
            names.push_back(name.get<std::string>());
        }
    incoming.answer(Json{{"parameters", parameters_.values(names)}});
}

void ParameterRequests::on_set(const Incoming& incoming)
{
    const Fields fields(incoming.header, "set");
    const Json values = parameters_.checked(fields.object("parameters"));
    const auto deadline = deadline_of(fields);
    if (fields.flag_or("check_only", false))
        return incoming.answer(Json{{"parameters", values}, {"previous", present_values(values)}});
    inbox_.command([this, values, deadline, answer = incoming.answer](Worker& worker) {
        if (Clock::now() >= deadline)
            return answer(
                Error(Errc::timeout, module_.self().name + " was busy until the deadline had passed; nothing was set"));
        try {
            answer(apply(worker, values));
        } catch (...) {
            answer(refusal(current_error()));
        }
    });
}

Json ParameterRequests::apply(Worker& worker, const Json& values)
{
    const Json before = present_values(values);
    worker.apply(values);
    module_.post([this] { state_file_.remember(); });
    return {{"parameters", present_values(values)}, {"previous", before}};
}

Json ParameterRequests::present_values(const Json& wanted) const
{
    Json values = Json::object();
    for (const auto& [name, value] : wanted.items())
        values.update(parameters_.values({name}));
    return values;
}

}  // namespace hive::service
