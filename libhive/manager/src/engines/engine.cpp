// Which engine has which name, and what all of them say to a drone.
#include "engine.hpp"

#include <hive/process.hpp>
#include <hive/program.hpp>

namespace hive {

std::unique_ptr<Engine> make_engine(const SwarmEngine& engine, const std::string& host,
                                    const std::filesystem::path& home)
{
    if (engine.name == "local")
        return make_local_engine(home);
    if (engine.name == "ssh")
        return make_ssh_engine(engine.settings, home);
    if (engine.name == "slurm")
        return make_slurm_engine(engine.settings, host, home);
    if (engine.name == "systemd")
        return make_systemd_engine(home);
    throw Error(Errc::unsupported, "there is no engine " + engine.name + " for " + host);
}

Error not_ready(const std::string& drone, int status, const std::string& last_words)
{
    return {Errc::failed, drone + " " + how_it_ended(status) + " before it was ready; its log says:\n"
                              + (last_words.empty() ? "(nothing)" : last_words)};
}

std::vector<std::string> arguments_of(const SwarmDrone& drone)
{
    std::vector<std::string> words{"--name", drone.name};
    for (const auto& [name, value] : drone.set.items())
        words.insert(words.end(), {"--set", assignment(name, value)});
    for (const auto& [flag, value] : {std::pair{"--on-exception", drone.on_exception},
                                      {"--listen", drone.listen},
                                      {"--advertise", drone.advertise},
                                      {"--key", drone.key},
                                      {"--log-level", drone.log_level}})
        if (!value.empty())
            words.insert(words.end(), {flag, value});
    for (const auto& [flag, chosen] : {std::pair{"--halted", drone.halted},
                                       {"--insecure", drone.insecure},
                                       {"--remote-operator", drone.remote_operator}})
        if (chosen)
            words.emplace_back(flag);
    return words;
}

}  // namespace hive
