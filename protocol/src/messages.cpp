// The JSON of hello, register, request, end and confirmation.
#include "receiver_name.hpp"

#include <hive/plain_text.hpp>
#include <hive/printable.hpp>
#include <hive/protocol/messages.hpp>

namespace hive::protocol {
Json to_json(const Hello& hello)
{
    Json json{{"name", hello.name}, {"kind", hello.kind}, {"epoch", hello.epoch}, {"pid", hello.pid}};
    if (hello.maps)
        json["maps"] = true;
    if (!hello.file.empty())
        json["file"] = hello.file;
    return json;
}

Hello hello_from_json(const Json& object)
{
    const Fields fields(object, "hello");
    return {fields.name("name"),
            fields.name("kind"),
            fields.integer("epoch", 0, max_json_integer),
            fields.integer_or("pid", 0, max_json_integer, 0),
            fields.flag_or("maps", false),
            fields.text_or("file", "")};
}

Json to_json(const Registration& registration)
{
    Json json{{"id", registration.id},
              {"epoch", registration.epoch},
              {"output", registration.output},
              {"receiver", registration.receiver},
              {"accepts", registration.accepts},
              {"stateful", registration.stateful},
              {"options", to_json(registration.options)}};
    if (registration.place != 0)
        json["place"] = registration.place;
    if (registration.taken)
        json["taken"] = *registration.taken;
    if (registration.held != 0)
        json["held"] = registration.held;
    if (registration.tried != 0)
        json["tried"] = registration.tried;
    return json;
}

Registration registration_from_json(const Json& object)
{
    const Fields fields(object, "register");
    Registration registration{.id = fields.integer("id", 0, max_json_integer),
                              .epoch = fields.integer("epoch", 0, max_json_integer),
                              .output = fields.name("output"),
                              .receiver = receiver_name(fields, "register"),
                              .accepts = fields.text_or("accepts", "*/*"),
                              .stateful = fields.flag_or("stateful", false),
                              .options = fields.has("options") ? connection_options(fields.object("options"))
                                                               : ConnectionOptions{},
                              .place = fields.integer_or("place", 0, max_json_integer, 0),
                              .taken = {},
                              .held = fields.integer_or("held", 0, max_json_integer, 0),
                              .tried = fields.integer_or("tried", 0, max_json_integer, 0)};
    if (fields.has("taken"))
        registration.taken = fields.integer("taken", 0, max_json_integer);
    return registration;
}

std::string to_text(const Request& request)
{
    std::string text;
    text.reserve(128);
    PlainWriter fields(text);
    fields.number(",\"epoch\":", request.epoch);
    fields.number(",\"id\":", request.id);
    fields.number(",\"done\":", request.done);
    if (request.worked != request.done)
        fields.number(",\"worked\":", request.worked);
    if (!request.back.empty())
        fields.raw(",\"back\":", hive::to_text(Json(request.back)));
    if (request.end != 0)
        fields.number(",\"end\":", request.end);
    if (request.end != 0 && request.within_ms != Request::most_within_ms)
        fields.number(",\"within_ms\":", request.within_ms);
    fields.close();
    return text;
}

Request request_from_text(std::string_view text)
{
    PlainReader place(text);
    Request request;
    if (!place.skip("{\"epoch\":") || !place.integer(request.epoch) || !place.skip(",\"id\":")
        || !place.integer(request.id) || !place.skip(",\"done\":") || !place.integer(request.done))
        return request_from_json(parse_json(text));
    request.worked = request.done;
    if ((place.skip(",\"worked\":") && !place.integer(request.worked)) || !place.skip("}") || !place.at_end())
        return request_from_json(parse_json(text));
    return request;
}

Request request_from_json(const Json& object)
{
    const Fields fields(object, "request");
    Request request{fields.integer("epoch", 0, max_json_integer), fields.integer("id", 0, max_json_integer),
                    fields.integer_or("done", 0, max_json_integer, 0)};
    request.worked = fields.integer_or("worked", 0, max_json_integer, request.done);
    request.end = fields.integer_or("end", 0, max_json_integer, 0);
    request.within_ms = fields.integer_or("within_ms", 0, Request::most_within_ms, Request::most_within_ms);
    if (fields.has("back"))
        for (const auto& item : fields.array("back")) {
            const auto number = json_integer(item);
            if (!number || *number < 1 || std::ssize(request.back) == Request::most_back)
                throw Error(Errc::malformed, "request: \"back\" must be an array of at most 64 integers from 1 on");
            request.back.push_back(*number);
        }
    return request;
}

void End::add(const std::string& more)
{
    constexpr std::size_t longest = most_text - 24;  // a character that is cut in two may become longer
    if (more.empty() || ("; " + text + "; ").find("; " + more + "; ") != std::string::npos)
        return;
    text = (text + (text.empty() ? "" : "; ") + more).substr(0, longest);
}

Json to_json(const End& end)
{
    Json json = Json::object();
    if (!end.text.empty())
        json["text"] = end.text;
    if (end.leaves)
        json["leaves"] = true;
    if (end.disconnected)
        json["disconnected"] = true;
    if (end.revoked)
        json["revoked"] = true;
    if (end.answers != 0)
        json["answers"] = end.answers;
    return json;
}

End end_from_json(const Json& object)
{
    const Fields fields(object, "end");
    End end{.text = fields.text_or("text", ""),
            .leaves = fields.flag_or("leaves", false),
            .disconnected = fields.flag_or("disconnected", false),
            .revoked = fields.flag_or("revoked", false),
            .answers = fields.integer_or("answers", 0, max_json_integer, 0)};
    if (end.text.size() > End::most_text)
        throw Error(Errc::malformed, "end: \"text\" has at most " + std::to_string(End::most_text) + " bytes");
    return end;
}

Json to_json(Confirmation confirmation)
{
    Json json{{"id", confirmation.id}};
    if (confirmation.time_us != 0)
        json["time_us"] = confirmation.time_us;
    if (confirmation.ok) {
        json["result"] = confirmation.result.is_null() ? Json::object() : std::move(confirmation.result);
        return json;
    }
    Json error{{"code", info(confirmation.code).token}, {"text", confirmation.text}};
    if (!confirmation.advice.empty())
        error["advice"] = confirmation.advice;
    json["error"] = std::move(error);
    return json;
}

Confirmation confirmation_from_json(Json object)
{
    const Fields fields(object, "confirmation");
    Confirmation confirmation;
    confirmation.id = fields.integer("id", 0, max_json_integer);
    confirmation.time_us = fields.integer_or("time_us", 0, max_json_integer, 0);
    if (fields.has("error")) {
        const Fields error(fields.object("error"), "confirmation error");
        confirmation.ok = false;
        confirmation.code = errc_from_token(error.text("code"));
        confirmation.text = shortened(error.text_or("text", ""));
        confirmation.advice = shortened(error.text_or("advice", ""));
    } else {
        static_cast<void>(fields.object("result"));
        confirmation.result = std::move(object["result"]);
    }
    return confirmation;
}

}  // namespace hive::protocol
