// The JSON of connect, disconnect, get, put, set and forget.
#include "receiver_name.hpp"

#include <hive/error.hpp>
#include <hive/protocol/requests.hpp>

namespace hive::protocol {

Json to_json(const Connect& connect)
{
    Json from{{"drone", connect.drone}, {"output", connect.output}};
    if (!connect.address.empty())
        from["address"] = connect.address;
    return {{"from", from}, {"input", connect.input}, {"options", to_json(connect.options)}};
}

Connect connect_from_json(const Json& object)
{
    const Fields fields(object, "connect");
    const Fields from(fields.object("from"), "connect: from");
    return {.drone = from.name("drone"),
            .output = from.name("output"),
            .address = from.text_or("address", ""),
            .input = fields.name("input"),
            .options = fields.has("options") ? connection_options(fields.object("options")) : ConnectionOptions{}};
}

Json to_json(const Disconnect& disconnect)
{
    Json object{{"from", {{"drone", disconnect.drone}}}};
    if (!disconnect.output.empty())
        object["from"]["output"] = disconnect.output;
    if (!disconnect.input.empty())
        object["input"] = disconnect.input;
    return object;
}

Disconnect disconnect_from_json(const Json& object)
{
    const Fields fields(object, "disconnect");
    const Fields from(fields.object("from"), "disconnect: from");
    return {.drone = from.name("drone"), .output = from.name_or("output", ""), .input = fields.name_or("input", "")};
}

Json to_json(const Get& get) { return {{"names", get.names}, {"asked", get.asked}}; }

Get get_from_json(const Json& object)
{
    const Fields fields(object, "get");
    Get get{.asked = fields.flag_or("asked", false)};
    if (fields.has("names"))
        for (const auto& name : fields.array("names")) {
            if (!name.is_string())
                throw Error(Errc::malformed, "get: \"names\" must be an array of texts");
            get.names.push_back(name.get<std::string>());
        }
    return get;
}

Json to_json(const Put& put) { return {{"input", put.input}, {"type", put.type}, {"header", put.header}}; }

Put put_from_json(const Json& object)
{
    const Fields fields(object, "put");
    return {.input = fields.name("input"),
            .type = fields.text("type"),
            .header = fields.has("header") ? fields.object("header") : Json::object(),
            .again = fields.has("source")};
}

Json to_json(const Set& set)
{
    if (set.commit)
        return {{"commit", *set.commit}};
    if (set.abort)
        return {{"abort", *set.abort}};
    Json json{{"parameters", set.parameters}, {"check_only", set.check_only}};
    if (set.prepare)
        json["prepare"] = *set.prepare;
    return json;
}

Set set_from_json(const Json& object)
{
    const Fields fields(object, "set");
    const auto token = [&](const char* key) {
        return fields.has(key) ? std::optional(fields.integer(key, 0, max_json_integer)) : std::nullopt;
    };
    Set set{.check_only = fields.flag_or("check_only", false),
            .prepare = token("prepare"),
            .commit = token("commit"),
            .abort = token("abort")};
    if (!set.commit && !set.abort)
        set.parameters = fields.object("parameters");
    return set;
}

Json to_json(const Forget& forget)
{
    Json object{{"receiver", forget.receiver}};
    if (!forget.output.empty())
        object["output"] = forget.output;
    return object;
}

Forget forget_from_json(const Json& object)
{
    const Fields fields(object, "forget");
    return {.output = fields.name_or("output", ""), .receiver = receiver_name(fields, "forget")};
}

}  // namespace hive::protocol
