// Writes and reads the fixed fields of an event's header.
#include "header_text.hpp"

#include <hive/error.hpp>
#include <hive/plain_text.hpp>

#include <algorithm>
#include <array>

namespace hive::event {
namespace {

void write_hops(std::string& text, const std::vector<Hop>& hops)
{
    text += '[';
    for (std::size_t i = hops.size() - std::min(hops.size(), most_hops); i < hops.size(); ++i) {
        if (text.back() != '[')
            text += ',';
        PlainWriter hop(text);
        hop.string(",\"drone\":", hops[i].drone);
        hop.number(",\"wait_us\":", hops[i].wait_us);
        hop.number(",\"work_us\":", hops[i].work_us);
        hop.close();
    }
    text += ']';
}

void write_shares(std::string& text, const std::vector<Share>& shares, const Share* own)
{
    text += '[';
    const auto write = [&](const Share& item) {
        if (text.back() != '[')
            text += ',';
        PlainWriter share(text);
        share.string(",\"of\":", item.of);
        share.number(",\"epoch\":", item.epoch);
        share.number(",\"turn\":", item.turn);
        if (item.attempt != 1)
            share.number(",\"attempt\":", item.attempt);
        if (item.closed != 0)
            share.number(",\"closed\":", item.closed);
        if (item.part != 0)
            share.number(",\"part\":", item.part);
        if (item.each)
            share.raw(",\"each\":", "true");
        if (!item.to.empty())
            share.string(",\"to\":", item.to);
        share.close();
    };
    std::ranges::for_each(shares, write);
    if (own)
        write(*own);
    text += ']';
}

bool read_signed(PlainReader& text, std::int64_t& value)
{
    const bool negative = text.skip("-");
    if (!text.integer(value) || (negative && value == 0))
        return false;
    value = negative ? -value : value;
    return true;
}

bool read_shares(PlainReader& text, std::vector<Share>& shares)
{
    if (!text.skip("["))
        return false;
    do {
        Share& share = shares.emplace_back();
        if (!text.skip("{\"of\":") || !text.string(share.of) || !is_share_name(share.of) || !text.skip(",\"epoch\":")
            || !text.integer(share.epoch) || !text.skip(",\"turn\":") || !text.integer(share.turn)
            || (text.skip(",\"attempt\":") && !text.integer(share.attempt, most_attempts))
            || (text.skip(",\"closed\":") && !text.integer(share.closed))
            || (text.skip(",\"part\":") && !text.integer(share.part, most_part))
            || (text.skip(",\"each\":") && !text.flag(share.each)) || (text.skip(",\"to\":") && !text.name(share.to))
            || !text.skip("}"))
            return false;
    } while (text.skip(","));
    return text.skip("]") && shares.size() <= most_shares;
}

bool read_hops(PlainReader& text, std::vector<Hop>& hops)
{
    if (!text.skip("["))
        return false;
    do {
        Hop& hop = hops.emplace_back();
        if (!text.skip("{\"drone\":") || !text.name(hop.drone) || !text.skip(",\"wait_us\":")
            || !text.integer(hop.wait_us) || !text.skip(",\"work_us\":") || !text.integer(hop.work_us)
            || !text.skip("}"))
            return false;
    } while (text.skip(","));
    return text.skip("]") && hops.size() <= most_hops;
}

/// The text up to the bracket that closes the first one; parse_json checks the content.
std::size_t object_size(std::string_view text)
{
    std::size_t depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '{' || c == '['))
            ++depth;
        else if (!quoted && (c == '}' || c == ']') && --depth == 0)
            return i + 1;
        if (depth == 0)
            return 0;
    }
    return 0;
}

/// Any object, with the limits of a nested one. `value` is an empty object.
bool read_object(PlainReader& text, Json& value)
try {
    if (text.skip("{}"))
        return true;  // as it was
    const auto size = object_size(text.rest());
    JsonLimits inside;
    --inside.depth;
    value = parse_json(text.rest().substr(0, size), inside);
    text.leave_out(size);
    return value.is_object();
} catch (const Error&) {
    return false;
}

using Read = bool (*)(PlainReader&, Event&);
struct Field {
    std::string_view key;  ///< with its punctuation
    Read read;
};

// The required ones first.
constexpr std::array known_fields{
    Field{"\"sender\":", [](PlainReader& text, Event& event) { return text.name(event.sender); }},
    Field{"\"kind\":", [](PlainReader& text, Event& event) { return text.name(event.kind); }},
    Field{"\"output\":", [](PlainReader& text, Event& event) { return text.name(event.output); }},
    Field{"\"type\":", [](PlainReader& text, Event& event) { return text.string(event.type); }},
    Field{"\"source\":", [](PlainReader& text, Event& event) { return text.name(event.identity.source); }},
    Field{"\"epoch\":", [](PlainReader& text, Event& event) { return text.integer(event.identity.epoch); }},
    Field{"\"seq\":", [](PlainReader& text, Event& event) { return text.integer(event.identity.sequence); }},
    Field{"\"time_us\":", [](PlainReader& text, Event& event) { return text.integer(event.identity.captured_us); }},
    Field{"\"mono_us\":", [](PlainReader& text, Event& event) { return text.integer(event.identity.monotonic_us); }},
    Field{"\"offset_us\":",
          [](PlainReader& text, Event& event) { return read_signed(text, event.identity.offset_us); }},
    Field{"\"size\":", [](PlainReader& text, Event& event) { return event.sized = text.integer(event.size); }},
    Field{"\"lossless\":", [](PlainReader& text, Event& event) { return text.flag(event.identity.lossless); }},
    Field{"\"part\":", [](PlainReader& text, Event& event) { return text.integer(event.identity.part, most_part); }},
    Field{"\"shares\":", [](PlainReader& text, Event& event) { return read_shares(text, event.identity.shares); }},
    Field{"\"hops\":", [](PlainReader& text, Event& event) { return read_hops(text, event.identity.hops); }},
    Field{"\"header\":", [](PlainReader& text, Event& event) { return read_object(text, event.header); }},
};
constexpr unsigned required_fields = (1u << 7) - 1;

}  // namespace

std::string header_text(const Event& event, const Share* own)
{
    const Identity& identity = event.identity;
    std::string text;
    text.reserve(512);
    PlainWriter header(text);
    header.string(",\"sender\":", event.sender);
    header.string(",\"kind\":", event.kind);
    header.string(",\"output\":", event.output);
    header.string(",\"type\":", event.type);
    header.string(",\"source\":", identity.source);
    header.number(",\"epoch\":", identity.epoch);
    header.number(",\"seq\":", identity.sequence);
    header.number(",\"time_us\":", identity.captured_us);
    header.number(",\"mono_us\":", identity.monotonic_us);
    if (identity.offset_us != 0)
        header.number(",\"offset_us\":", identity.offset_us);
    if (event.sized || !event.body.empty())
        header.number(",\"size\":", static_cast<std::int64_t>(event.body.empty() ? event.size : event.body.size()));
    if (identity.lossless)
        header.raw(",\"lossless\":", "true");
    if (identity.part > 0)
        header.number(",\"part\":", identity.part);
    if (own || !identity.shares.empty())
        write_shares(text += ",\"shares\":", identity.shares, own);
    if (!identity.hops.empty())
        write_hops(text += ",\"hops\":", identity.hops);
    header.raw(",\"header\":", to_text(event.header));
    header.close();
    return text;
}

bool read_plain_header(std::string_view text, Event& event)
{
    if (text.size() > JsonLimits{}.bytes)
        return false;
    PlainReader place(text);
    unsigned seen = 0;
    std::size_t next = 0;
    if (!place.skip("{"))
        return false;
    do {
        std::size_t tried = 0;
        while (tried < known_fields.size() && !place.skip(known_fields[next].key)) {
            next = (next + 1) % known_fields.size();  // they usually come in this order
            ++tried;
        }
        if (tried == known_fields.size() || (seen & (1u << next)) != 0 || !known_fields[next].read(place, event))
            return false;
        seen |= 1u << next;
    } while (place.skip(","));
    return place.skip("}") && place.at_end() && (seen & required_fields) == required_fields;
}

}  // namespace hive::event
