// Writing and reading the fixed fields of an event's header.
#include "header_text.hpp"

#include <hive/error.hpp>
#include <hive/name.hpp>

#include <algorithm>
#include <array>
#include <charconv>

namespace hive::event {
namespace {

constexpr auto plain = [](char c) { return c >= ' ' && c <= '~' && c != '"' && c != '\\'; };

/// Writes the fields of one object; each key is given as it stands in the text, with the comma before it.
class Writer {
public:
    explicit Writer(std::string& text) : text_(text), begin_(text.size()) {}
    void close()
    {
        text_[begin_] = '{';  // the first comma
        text_ += '}';
    }

    void raw(std::string_view key, std::string_view value) { (text_ += key) += value; }
    void number(std::string_view key, std::int64_t value)
    {
        std::array<char, 24> digits{};
        raw(key, {digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr});
    }
    void string(std::string_view key, const std::string& value)
    {
        if (std::ranges::all_of(value, plain))
            (((text_ += key) += '"') += value) += '"';
        else
            raw(key, to_text(Json(value)));
    }

private:
    std::string& text_;
    std::size_t begin_;
};

void write_hops(std::string& text, const std::vector<Hop>& hops)
{
    text += '[';
    for (std::size_t i = hops.size() - std::min(hops.size(), most_hops); i < hops.size(); ++i) {
        if (text.back() != '[')
            text += ',';
        Writer hop(text);
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
    const auto write = [&](const Share& each) {
        if (text.back() != '[')
            text += ',';
        Writer share(text);
        share.string(",\"of\":", each.of);
        share.number(",\"epoch\":", each.epoch);
        share.number(",\"turn\":", each.turn);
        if (each.attempt != 1)
            share.number(",\"attempt\":", each.attempt);
        if (each.closed != 0)
            share.number(",\"closed\":", each.closed);
        if (each.part != 0)
            share.number(",\"part\":", each.part);
        if (!each.to.empty())
            share.string(",\"to\":", each.to);
        share.close();
    };
    std::ranges::for_each(shares, write);
    if (own)
        write(*own);
    text += ']';
}

/// A place in a text; every function moves on when it finds what it looks for, and gives false or nothing otherwise.
class Plain {
public:
    explicit Plain(std::string_view rest) : rest_(rest) {}

    [[nodiscard]] bool at_end() const { return rest_.empty(); }
    bool skip(std::string_view word)
    {
        if (!rest_.starts_with(word))
            return false;
        rest_.remove_prefix(word.size());
        return true;
    }
    bool string(std::string& value)
    {
        if (!skip("\""))
            return false;
        const auto end = static_cast<std::size_t>(std::ranges::find_if_not(rest_, plain) - rest_.begin());
        if (end > JsonLimits{}.string_bytes)
            return false;
        value.assign(rest_, 0, end);
        rest_.remove_prefix(end);
        return skip("\"");
    }
    bool name(std::string& value) { return string(value) && is_name(value); }
    template <class Integer>
    bool integer(Integer& value, std::int64_t most = max_json_integer)
    {
        return !rest_.starts_with('-') && any_integer(value, most);
    }
    template <class Integer>
    bool any_integer(Integer& value, std::int64_t most = max_json_integer)
    {
        const auto digits_of = rest_.substr(rest_.starts_with('-') ? 1 : 0);
        const bool zero_first = digits_of.starts_with('0');
        std::int64_t number = 0;
        const auto [end, problem] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
        const auto size = static_cast<std::size_t>(end - rest_.data());
        if (problem != std::errc() || (zero_first && size > 1) || number > most || number < -most)
            return false;
        rest_.remove_prefix(size);
        value = static_cast<Integer>(number);
        return true;
    }
    bool flag(bool& value)
    {
        value = rest_.starts_with('t');
        return skip(value ? "true" : "false");
    }
    bool shares(std::vector<Share>& shares)
    {
        if (!skip("["))
            return false;
        do {
            Share& share = shares.emplace_back();
            if (!skip("{\"of\":") || !string(share.of) || !is_share_name(share.of) || !skip(",\"epoch\":")
                || !integer(share.epoch) || !skip(",\"turn\":") || !integer(share.turn)
                || (skip(",\"attempt\":") && !integer(share.attempt, most_attempts))
                || (skip(",\"closed\":") && !integer(share.closed))
                || (skip(",\"part\":") && !integer(share.part, most_part)) || (skip(",\"to\":") && !name(share.to))
                || !skip("}"))
                return false;
        } while (skip(","));
        return skip("]") && shares.size() <= most_shares;
    }
    bool hops(std::vector<Hop>& hops)
    {
        if (!skip("["))
            return false;
        do {
            Hop& hop = hops.emplace_back();
            if (!skip("{\"drone\":") || !name(hop.drone) || !skip(",\"wait_us\":") || !integer(hop.wait_us)
                || !skip(",\"work_us\":") || !integer(hop.work_us) || !skip("}"))
                return false;
        } while (skip(","));
        return skip("]") && hops.size() <= most_hops;
    }
    /// Any object, with the limits of one that is inside another.
    bool object(Json& value)
    try {
        if (skip("{}")) {
            value = Json::object();
            return true;
        }
        const auto size = object_size();
        JsonLimits inside;
        --inside.depth;
        value = parse_json(rest_.substr(0, size), inside);
        rest_.remove_prefix(size);
        return value.is_object();
    } catch (const Error&) {
        return false;
    }

private:
    /// Up to the bracket that closes the first one; parse_json judges what is between.
    [[nodiscard]] std::size_t object_size() const
    {
        std::size_t depth = 0;
        bool quoted = false;
        for (std::size_t i = 0; i < rest_.size(); ++i) {
            const char c = rest_[i];
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

    std::string_view rest_;
};

using Read = bool (*)(Plain&, Event&);
struct Field {
    std::string_view key;  ///< as it stands in the text
    Read read;
};

// The required ones first.
constexpr std::array known_fields{
    Field{"\"sender\":", [](Plain& text, Event& event) { return text.name(event.sender); }},
    Field{"\"kind\":", [](Plain& text, Event& event) { return text.name(event.kind); }},
    Field{"\"output\":", [](Plain& text, Event& event) { return text.name(event.output); }},
    Field{"\"type\":", [](Plain& text, Event& event) { return text.string(event.type); }},
    Field{"\"source\":", [](Plain& text, Event& event) { return text.name(event.identity.source); }},
    Field{"\"epoch\":", [](Plain& text, Event& event) { return text.integer(event.identity.epoch); }},
    Field{"\"seq\":", [](Plain& text, Event& event) { return text.integer(event.identity.sequence); }},
    Field{"\"time_us\":", [](Plain& text, Event& event) { return text.integer(event.identity.captured_us); }},
    Field{"\"mono_us\":", [](Plain& text, Event& event) { return text.integer(event.identity.monotonic_us); }},
    Field{"\"offset_us\":", [](Plain& text, Event& event) { return text.any_integer(event.identity.offset_us); }},
    Field{"\"size\":", [](Plain& text, Event& event) { return event.sized = text.integer(event.size); }},
    Field{"\"lossless\":", [](Plain& text, Event& event) { return text.flag(event.identity.lossless); }},
    Field{"\"part\":", [](Plain& text, Event& event) { return text.integer(event.identity.part, most_part); }},
    Field{"\"shares\":", [](Plain& text, Event& event) { return text.shares(event.identity.shares); }},
    Field{"\"hops\":", [](Plain& text, Event& event) { return text.hops(event.identity.hops); }},
    Field{"\"header\":", [](Plain& text, Event& event) { return text.object(event.header); }},
};
constexpr unsigned required_fields = (1u << 7) - 1;

}  // namespace

std::string header_text(const Event& event, const Share* own)
{
    const Identity& identity = event.identity;
    std::string text;
    text.reserve(512);
    Writer header(text);
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
    Plain place(text);
    unsigned seen = 0;
    std::size_t next = 0;
    if (!place.skip("{"))
        return false;
    do {
        std::size_t tried = 0;
        while (tried < known_fields.size() && !place.skip(known_fields[next].key)) {
            next = (next + 1) % known_fields.size();  // they mostly come in this order
            ++tried;
        }
        if (tried == known_fields.size() || (seen & (1u << next)) != 0 || !known_fields[next].read(place, event))
            return false;
        seen |= 1u << next;
    } while (place.skip(","));
    return place.skip("}") && place.at_end() && (seen & required_fields) == required_fields;
}

}  // namespace hive::event
