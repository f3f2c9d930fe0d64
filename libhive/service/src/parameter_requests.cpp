// Reads parameters at once, and sets them between two callbacks.
#include "parameter_requests.hpp"

#include <hive/protocol/requests.hpp>

namespace hive::service {

using event::Incoming;

namespace {

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
    const auto set = protocol::set_from_json(incoming.header);
    const Json values = parameters_.checked(set.parameters);
    if (set.check_only)
        return incoming.answer(Json{{"parameters", values}, {"previous", present_values(values)}});
    inbox_.command([this, values, asked = incoming.asked, answer = incoming.answer](Worker& worker) {
        if (!asked->begin())
            return;  // its deadline has answered, or is about to
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
