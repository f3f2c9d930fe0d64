// The texts of a camera: the lists of param.cgi, and the heads of HTTP and RTSP replies. Whatever a camera writes, what
// is kept of it can be printed, and one that is refused stays refused. Input: the text.
#include "parameter_text.hpp"
#include "reply_guard.hpp"
#include "require.hpp"

#include <hive/json.hpp>

#include <cstdint>
#include <string_view>

namespace {

using hive::fuzz::require;

bool printable(const std::string& text) { return !hive::to_text(hive::Json(text)).empty(); }

void read_parameters(std::string_view text)
{
    const auto list = axis::parse_parameters(text);
    for (const auto& [name, value] : list.values)
        require(printable(name) && printable(value), "a parameter can be printed");
    for (const auto& error : list.errors)
        require(printable(error), "an error can be printed");
    if (const auto refusal = axis::refusal_of(text))
        require(printable(*refusal), "a refusal can be printed");
    const auto query = axis::update_query(list.values);
    require(query.find_first_of(" \r\n\"<>") == std::string::npos, "a query is one word");
}

void read_replies(std::string_view text, bool rtsp)
{
    camera::ReplyRules rules;
    rules.rtsp = rtsp;
    rules.has_login = true;
    camera::ReplyGuard guard(rules);
    std::string refusal;
    while (!text.empty()) {
        const auto line = text.substr(0, text.find('\n'));
        guard.take(line);
        require(refusal.empty() || guard.refusal() == refusal, "the first refusal stays");
        refusal = guard.refusal();
        require(refusal.size() < 500 && printable(refusal), "a refusal is one sentence");
        text.remove_prefix(std::min(text.size(), line.size() + 1));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    read_parameters(text);
    read_replies(text, false);
    read_replies(text, true);
    return 0;
}
