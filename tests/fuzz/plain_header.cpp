// The header of an event: the reader of plain headers and the reader of all JSON agree about it, and it is written and
// read as the same. Input: the text of the header.
#include "require.hpp"

#include <hive/error.hpp>
#include <hive/event_text.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace {

using hive::fuzz::require;

/// The event as text; nothing when it is refused.
std::optional<std::string> reread(std::string_view text)
{
    try {
        return hive::event_text(hive::event_from_text(text));
    } catch (const hive::Error&) {
        return std::nullopt;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    const std::string text(reinterpret_cast<const char*>(bytes), size);
    const auto event = reread(text);
    if (text.starts_with('{') && text.size() < 60'000)  // a space is nothing that a plain header has
        require(event == reread("{ " + text.substr(1)), "both readers agree");
    if (event)
        require(reread(*event) == event, "an event survives the way");
    return 0;
}
