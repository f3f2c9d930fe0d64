// A header: refused by an Error, or valid JSON within the limits; a message read from it is written and read the same.
// Input: one byte for the message, then the text.
#include "require.hpp"

#include <hive/protocol/messages.hpp>
#include <hive/protocol/requests.hpp>
#include <hive/status.hpp>

#include <algorithm>
#include <vector>

namespace {

using hive::Json;
using hive::fuzz::require;
using namespace hive::protocol;

std::size_t depth(const Json& value)
{
    std::size_t deepest = 0;
    for (const auto& item : value)
        if (value.is_structured())
            deepest = std::max(deepest, depth(item));
    return deepest + value.is_structured();
}

/// What the message says, as JSON again.
Json reread(unsigned message, const Json& header)
{
    switch (message % 9) {
    case 0: return to_json(hello_from_json(header));
    case 1: return to_json(registration_from_json(header));
    case 2: return hive::parse_json(to_text(request_from_text(hive::to_text(header))));
    case 3: return to_json(confirmation_from_json(header));
    case 4: return to_json(hive::connection_options(header));
    case 5: return to_json(connect_from_json(header));
    case 6: return to_json(set_from_json(header));
    case 7: return to_json(forget_from_json(header));
    default: return to_json(hive::status_from_json(header));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size == 0)
        return 0;
    const std::string_view text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    try {
        const Json header = hive::parse_json(text);
        require(Json::accept(text), "what is accepted is JSON");
        require(depth(header) <= hive::JsonLimits{}.depth, "the depth is limited");
        require(hive::parse_json(hive::to_text(header), {.bytes = 1 << 22, .string_bytes = 1 << 20}) == header,
                "a value survives the way");
        const Json value = reread(bytes[0], header);
        require(reread(bytes[0], value) == value, "a message survives the way");
        require(hive::parse_json(hive::to_text(value), {.bytes = 1 << 22}) == value, "a message survives as text");
    } catch (const hive::Error&) {  // a refusal is an answer
    }
    return 0;
}
