// The JSON of connect, set and forget.
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
    Forget forget{.output = fields.name_or("output", ""), .receiver = fields.text("receiver")};
    if (forget.receiver.empty())
        throw Error(Errc::malformed, "forget: \"receiver\" must not be empty");
    return forget;
}

}  // namespace hive::protocol
