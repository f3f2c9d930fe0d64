// A swarm file: it has mistakes, each with a place in it and a sentence, or its plan is written and read as the same.
// Input: the text of the file.
#include "require.hpp"

#include <hive/error.hpp>
#include <hive/swarm_plan.hpp>

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace {

using hive::fuzz::require;

void check(const std::vector<hive::Mistake>& mistakes, std::size_t lines)
{
    for (const auto& mistake : mistakes) {
        require(mistake.line <= lines, "a mistake is in the file");
        require(!mistake.text.empty(), "a mistake is told");
        require(!hive::to_text(hive::Json(mistake.text + mistake.at + mistake.advice)).empty(), "it can be printed");
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes), size);
    const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n')) + 1;
    const auto reading = hive::read_swarm(text);
    check(reading.mistakes, lines);
    check(reading.notes, lines);
    if (!reading.mistakes.empty())
        return 0;
    const auto again = hive::read_swarm(hive::to_text(reading.plan));
    require(again.mistakes.empty(), "a plan that is written can be read");
    require(again.plan == reading.plan, "a plan survives the way");
    return 0;
}
