// The headers of messages: what each says, and what is refused.
#include "vectors.hpp"

#include <hive/event_text.hpp>
#include <hive/interface.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/protocol/requests.hpp>
#include <hive/status.hpp>

#include <map>

namespace hive::wire {
namespace {

/// Reads a header and writes it again as libhive does (protocol/vectors/README.md).
Json normal_form(const std::string& message, const Json& header)
{
    using namespace hive::protocol;
    static const std::map<std::string, std::function<Json(const Json&)>> readers{
        {"hello", [](const Json& json) { return to_json(hello_from_json(json)); }},
        {"register", [](const Json& json) { return to_json(registration_from_json(json)); }},
        {"request", [](const Json& json) { return parse_json(to_text(request_from_text(to_text(json)))); }},
        {"end", [](const Json& json) { return to_json(end_from_json(json)); }},
        {"segment", [](const Json& json) { return to_json(segment_from_json(json)); }},
        {"confirmation", [](const Json& json) { return to_json(confirmation_from_json(json)); }},
        {"connect", [](const Json& json) { return to_json(connect_from_json(json)); }},
        {"disconnect", [](const Json& json) { return to_json(disconnect_from_json(json)); }},
        {"get", [](const Json& json) { return to_json(get_from_json(json)); }},
        {"put", [](const Json& json) { return to_json(put_from_json(json)); }},
        {"set", [](const Json& json) { return to_json(set_from_json(json)); }},
        {"forget", [](const Json& json) { return to_json(forget_from_json(json)); }},
        {"status", [](const Json& json) { return hive::to_json(status_from_json(json)); }},
        {"event", [](const Json& json) { return parse_json(event_text(event_from_text(to_text(json), {}))); }},
        {"interface", [](const Json& json) { return hive::to_json(interface_from_json(json)); }},
    };
    return readers.at(message)(header);
}

}  // namespace

TEST_CASE("message vectors: each header is read with its defaults, or refused with its code")
{
    for (const auto& row : read_vectors("messages.jsonl", 200)) {
        CAPTURE(row.at("name"));
        const auto message = row.at("message").get<std::string>();
        Json value;
        check_outcome(row, error_of([&] { value = normal_form(message, row.at("header")); }));
        if (row.contains("error"))
            continue;
        CHECK_EQ(value, row.at("value"));
        CHECK_EQ(normal_form(message, value), value);
    }
}

}  // namespace hive::wire
