// Tokens of the enumerations, connection options as JSON, and the matching of media types.
#include <hive/encoding.hpp>
#include <hive/error.hpp>
#include <hive/transfer.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace hive {
namespace {

template <class Enum>
struct Tokens;
template <>
struct Tokens<Transfer> {
    static constexpr std::array all{std::pair{Transfer::synchronized, "sync"},
                                    std::pair{Transfer::streaming, "stream"}};
};
template <>
struct Tokens<Delivery> {
    static constexpr std::array all{std::pair{Delivery::data, "data"}, std::pair{Delivery::notification, "notify"}};
};
template <>
struct Tokens<State> {
    static constexpr std::array all{std::pair{State::starting, "starting"}, std::pair{State::idle, "idle"},
                                    std::pair{State::busy, "busy"}, std::pair{State::halted, "halted"},
                                    std::pair{State::stopping, "stopping"}};
};
template <>
struct Tokens<ExceptionPolicy> {
    static constexpr std::array all{std::pair{ExceptionPolicy::skip, "skip"}, std::pair{ExceptionPolicy::halt, "halt"}};
};

template <class Enum>
std::string_view token_of(Enum value) noexcept
{
    for (const auto& [enumerator, text] : Tokens<Enum>::all)
        if (enumerator == value)
            return text;
    return {};
}

template <class Visit>
bool any_type(std::string_view list, Visit visit)
{
    while (!list.empty()) {
        const auto comma = list.find(',');
        if (visit(list.substr(0, comma)))
            return true;
        list = comma == std::string_view::npos ? std::string_view() : list.substr(comma + 1);
    }
    return false;
}

bool part_fits(std::string_view a, std::string_view b) { return a == "*" || b == "*" || a == b; }

bool type_fits(std::string_view a, std::string_view b)
{
    const auto slash_a = a.find('/'), slash_b = b.find('/');
    if (slash_a == std::string_view::npos || slash_b == std::string_view::npos)
        return a == b;
    return part_fits(a.substr(0, slash_a), b.substr(0, slash_b))
           && part_fits(a.substr(slash_a + 1), b.substr(slash_b + 1));
}

}  // namespace

std::string_view token(Transfer value) noexcept { return token_of(value); }
std::string_view token(Delivery value) noexcept { return token_of(value); }
std::string_view token(State value) noexcept { return token_of(value); }
std::string_view token(ExceptionPolicy value) noexcept { return token_of(value); }

template <class Enum>
Enum from_token(std::string_view text, std::string_view what)
{
    std::string known;
    for (const auto& [enumerator, name] : Tokens<Enum>::all) {
        if (text == name)
            return enumerator;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw Error(Errc::malformed, std::string(what) + " must be one of " + known + ", not " + in_quotes(text));
}
template Transfer from_token<Transfer>(std::string_view, std::string_view);
template Delivery from_token<Delivery>(std::string_view, std::string_view);
template State from_token<State>(std::string_view, std::string_view);
template ExceptionPolicy from_token<ExceptionPolicy>(std::string_view, std::string_view);

Json to_json(const ConnectionOptions& options)
{
    Json object{
        {"transfer", token(options.transfer)}, {"delivery", token(options.delivery)}, {"window", options.window}};
    if (!options.group.empty())
        object["group"] = options.group;
    if (options.first_frame)
        object["first_frame"] = true;
    if (options.lease)
        object["lease_ms"] = options.lease->count();
    if (!options.encoding.empty())
        object["encoding"] = options.encoding;
    return object;
}

ConnectionOptions connection_options(const Json& object)
{
    const Fields fields(object, "connection options");
    ConnectionOptions options;
    options.transfer = from_token<Transfer>(fields.text_or("transfer", "sync"), "transfer");
    options.delivery = from_token<Delivery>(fields.text_or("delivery", "data"), "delivery");
    options.window = static_cast<int>(fields.integer_or("window", 1, 64, 1));
    options.group = fields.name_or("group", "");
    options.first_frame = fields.flag_or("first_frame", false);
    if (fields.has("lease_ms"))
        options.lease = std::chrono::milliseconds(fields.integer("lease_ms", 50, 86'400'000));
    options.encoding = fields.text_or("encoding", "");
    if (fields.has("encoding") && !is_encoding(options.encoding))
        throw Error(Errc::malformed,
                    "connection options: an encoding is a word, with a number if wanted (raw, jpeg:80), not "
                        + in_quotes(options.encoding));
    if (!options.group.empty() && (options.transfer != Transfer::synchronized || options.delivery != Delivery::data))
        throw Error(Errc::malformed, "a group shares whole events by request: stream and notify conflict with it");
    if (!options.group.empty() && options.first_frame)
        throw Error(Errc::malformed, "a group gives each event to one member: first_frame, which starts with an event "
                                     "that others may have had, conflicts with it");
    return options;
}

bool types_fit(std::string_view output_types, std::string_view input_types)
{
    return any_type(output_types, [&](std::string_view output) {
        return any_type(input_types, [&](std::string_view input) { return type_fits(output, input); });
    });
}

}  // namespace hive
