// Writes causes as JSON and as one line.
#include <hive/explain.hpp>

#include <algorithm>
#include <array>
#include <span>

namespace hive {
namespace {

constexpr std::array tokens{
    std::string_view("not_running"),
    std::string_view("crashed"),
    std::string_view("failed"),
    std::string_view("suspended"),
    std::string_view("no_answer"),
    std::string_view("unreachable"),
    std::string_view("refused"),
    std::string_view("starting"),
    std::string_view("halted"),
    std::string_view("set_prepared"),
    std::string_view("throws"),
    std::string_view("stuck"),
    std::string_view("source_ended"),
    std::string_view("condition"),
    std::string_view("not_connected"),
    std::string_view("wrong_way"),
    std::string_view("wrong_types"),
    std::string_view("dialing"),
    std::string_view("held"),
    std::string_view("no_receiver"),
    std::string_view("watched"),
    std::string_view("receiver_away"),
    std::string_view("waits"),
    std::string_view("slow"),
    std::string_view("slow_connection"),
    std::string_view("small_window"),
    std::string_view("copied"),
    std::string_view("encoder"),
    std::string_view("clock"),
    std::string_view("load"),
    std::string_view("memory"),
    std::string_view("same_name"),
    std::string_view("emits_nothing"),
    std::string_view("silent_source"),
};
static_assert(tokens.size() == static_cast<std::size_t>(Cause::What::silent_source) + 1);

}  // namespace

std::string_view token(Cause::What what) noexcept { return tokens[static_cast<std::size_t>(what)]; }

Json to_json(const Cause& cause)
{
    return {{"what", token(cause.what)}, {"drone", cause.drone},       {"connection", cause.connection},
            {"text", cause.text},        {"evidence", cause.evidence}, {"command", cause.command},
            {"blocks", cause.blocks}};
}

Json to_json(const Explanation& explanation)
{
    Json causes = Json::array(), flows = Json::array();
    for (const auto& cause : explanation.causes)
        causes.push_back(to_json(cause));
    for (const auto& flow : explanation.flows)
        flows.push_back({{"drone", flow.drone},
                         {"received_per_s", flow.received_per_s},
                         {"emitted_per_s", flow.emitted_per_s},
                         {"age_us", flow.age_us}});
    return {{"text", to_text(explanation)}, {"causes", causes}, {"flows", flows}};
}

std::string to_text(const Explanation& explanation)
{
    constexpr std::size_t max_named = 3;
    std::string text;
    const bool blocked = !explanation.causes.empty() && explanation.causes.front().blocks;
    const std::span causes(explanation.causes);
    for (const auto& cause : causes.first(std::min(causes.size(), max_named)))
        if (cause.blocks == blocked)
            text += (text.empty() ? "" : "; also: ") + cause.text
                    + (cause.evidence.empty() ? "" : " (" + cause.evidence + ")")
                    + (cause.command.empty() ? "" : "; try: " + cause.command);
    return text;
}

}  // namespace hive
