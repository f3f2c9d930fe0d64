// Lets the caller's code encode the events of an output for each connection.
#include "declared.hpp"
#include "drone_object.hpp"
#include "texts.hpp"

#include <algorithm>

using namespace hive;
using namespace hive::c;

namespace {

Encoding encoding_of(const Json& item)
{
    const Options given(to_text(item).c_str(), {"word", "type", "least", "most"});
    Encoding encoding{.word = given.text("word"), .type = given.text("type")};
    if (!is_encoding(encoding.word) || encoding.word.find(':') != std::string::npos)
        throw Error(Errc::invalid_argument, in_quotes(encoding.word) + " is not an encoding");
    if (encoding.type.empty())
        throw Error(Errc::invalid_argument, "encoding " + encoding.word + " gives no media type");
    if (given.number("least") || given.number("most")) {
        encoding.least = given.integer("least", 0, 0);
        encoding.most = given.integer("most", encoding.least, encoding.least);
    }
    return encoding;
}

std::vector<Encoding> encodings_of(const char* text)
{
    const Json list = json_of(required(text, "the encodings"), "the encodings");
    if (!list.is_array() || list.empty())
        throw Error(Errc::invalid_argument, "the encodings are not an array of one or more");
    std::vector<Encoding> encodings;
    for (const auto& item : list) {
        encodings.push_back(encoding_of(item));
        if (std::ranges::count(encodings, encodings.back().word, &Encoding::word) > 1)
            throw Error(Errc::invalid_argument, "encoding " + encodings.back().word + " is there twice");
    }
    return encodings;
}

/// The answer of the caller's code.
class EncodedObject final : public Object {
public:
    using Handle = hive_encoded;
    static constexpr const char* name = "hive_encoded";

    void give(std::optional<Json> header, Body body)
    {
        const std::lock_guard lock(mutex_);
        header_ = std::move(header);
        body_ = std::move(body);
    }
    /// Throws Errc::invalid_argument without an answer.
    void take(Event& event)
    {
        const std::lock_guard lock(mutex_);
        if (!body_)
            throw Error(Errc::invalid_argument, "the encoder returned nothing");
        if (header_)
            event.header = std::move(*header_);
        event.body = std::move(*body_);
        event.size = event.body.size();
    }

private:
    std::mutex mutex_;
    std::optional<Json> header_;
    std::optional<Body> body_;
};

/// On the thread of the encoder.
Event encode(const Event& event, const std::string& encoding, hive_encode_callback callback, void* user)
{
    Event result = event;
    result.ticket = {};
    const auto answer = std::make_shared<EncodedObject>();
    auto* const handle = give(answer);
    const std::shared_ptr<void> released(nullptr, [handle](void*) { hive_release(handle); });
    const Lent lent(result);
    const LibraryThread here;
    forget_error();
    require_done(callback(user, *lent.data(), encoding.c_str(), handle));
    answer->take(result);
    return result;
}

}  // namespace

hive_code hive_drone_encoded_output(hive_drone* drone, const char* name, const char* type, const char* help,
                                    const char* encodings, hive_encode_callback callback, void* user,
                                    hive_output** output)
{
    return guarded([&] {
        required(output, "the place for the output");
        required(callback, "the callback");
        const auto object = get<DroneObject>(drone);
        const auto open = object->declaring();
        const auto known = encodings_of(encodings);
        const auto named = text_of(name, "the name"), types = text_of(type, "the type");
        require_output(open->interface(), named, types);
        Encoder encoder{.encodings = known,
                        .encode = [known, callback, user](const Event& event, const std::string& encoding) {
                            Event result = encode(event, encoding, callback, user);
                            result.type = encoding_named(known, encoding).type;
                            return result;
                        }};
        const auto made = open->drone().output(named, types, text_or_empty(help), std::move(encoder));
        *output = give(std::make_shared<OutputObject>(object, made));
    });
}

hive_code hive_encoded_give(hive_encoded* encoded, const char* header, size_t length, const hive_body* body)
{
    return guarded([&] {
        const auto object = get<EncodedObject>(encoded);
        auto changed = header ? std::optional(header_of(header, length)) : std::nullopt;
        object->give(std::move(changed), get<BodyObject>(body)->body);
    });
}
