// The process of one drone: the arguments of its program, and how it ended.
#include "engine.hpp"

#include <hive/program.hpp>

#include <algorithm>
#include <iterator>

#include <sys/wait.h>

namespace hive {

Errc errc_of_exit(int code)
{
    for (const auto error : {Errc::invalid_argument, Errc::not_found, Errc::unreachable, Errc::refused,
                             Errc::type_mismatch, Errc::halted, Errc::timeout})
        if (info(error).exit_code == code)
            return error;
    return Errc::failed;
}

Errc errc_of_status(int status) { return WIFEXITED(status) ? errc_of_exit(WEXITSTATUS(status)) : Errc::failed; }

std::string log_text(const std::string& last_words)
{
    const auto end = last_words.find_last_not_of('\n') + 1;
    return "its log says:\n" + (end == 0 ? "(nothing)" : last_words.substr(0, end));
}

std::string subject_of(const SwarmDrone& drone) { return (takes_over(drone) ? "the successor of " : "") + drone.name; }

Error not_ready(const std::string& drone, int status, const std::string& last_words)
{
    return {errc_of_status(status), drone + " " + how_its_start_ended(status) + "; " + log_text(last_words)};
}

std::string assignment(const std::string& parameter, const Json& value)
{
    return parameter + "=" + (value.is_string() ? value.get<std::string>() : value.dump());
}

std::vector<std::string> arguments_of(const SwarmDrone& drone)
{
    std::vector<std::string> words{"--name", drone.name};
    for (const auto& [name, value] : drone.set.items())
        words.insert(words.end(), {"--set", assignment(name, value)});
    std::ranges::move(option_words(drone), std::back_inserter(words));
    if (!drone.swarm.empty())
        words.insert(words.end(), {"--swarm", drone.swarm});
    if (takes_over(drone))
        words.insert(words.end(), {"--take-over", std::to_string(drone.take_over_s)});
    for (const auto& connection : drone.connections)
        words.insert(words.end(), {"--connect", connection});
    for (const auto& receiver : drone.expected)
        words.insert(words.end(), {"--expect", receiver});
    return words;
}

}  // namespace hive
