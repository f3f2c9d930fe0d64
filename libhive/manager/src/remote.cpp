// Writes the command lines for ssh, and interprets its failures.
#include "directory.hpp"
#include "engines/engine.hpp"
#include "last_line.hpp"

#include <hive/error.hpp>
#include <hive/failure.hpp>
#include <hive/json.hpp>
#include <hive/name.hpp>
#include <hive/remote.hpp>
#include <hive/transport/address.hpp>

#include <algorithm>
#include <sstream>
#include <sys/un.h>

namespace hive {
namespace {

/// A host name, a number, or USER@HOST; never an option of ssh.
const std::string& require_host(const std::string& ssh)
{
    const bool fits = !ssh.empty() && ssh.size() <= 255 && ssh.front() != '-'
                      && std::ranges::all_of(ssh, [](unsigned char c) { return c > ' ' && c < 0x7F; })
                      && ssh.find_first_of("'\"`$;&|<>()\\/") == std::string::npos;
    if (!fits)
        throw Error(Errc::invalid_argument, in_quotes(ssh) + " is not a valid ssh host", "write HOST or USER@HOST");
    return ssh;
}

/// The ControlPath of the shared connection, in ssh's syntax; empty if it is not possible.
std::string control_path(const std::filesystem::path& home)
{
    constexpr std::size_t digest = 40, name_while_made = 17;
    const auto path = (home / ".ssh-").string();
    const bool fits = path.size() + digest + name_while_made < sizeof(sockaddr_un::sun_path);
    if (!fits || path.find_first_of("\"\\\n") != std::string::npos)
        return "";
    std::string written = "\"";
    for (const char c : path)
        written += c == '%' ? "%%" : std::string(1, c);
    return written + "%C\"";
}

}  // namespace

std::string quoted_for_shell(const std::string& word)
{
    std::string text = "'";
    for (const char c : word)
        text += c == '\'' ? "'\\''" : std::string(1, c);
    return text + "'";
}

std::string copy_of_key(const std::filesystem::path& file, const std::string& ssh)
{
    return "ssh " + ssh + " mkdir -p .config/hive && scp " + file.string() + " " + ssh + ":.config/hive/swarm.key";
}

Remote::Remote(std::string ssh, const std::filesystem::path& home) : ssh_(std::move(ssh)), home_(home)
{
    require_host(ssh_);
}

std::string Remote::host() const { return machine_name(ssh_); }

std::string Remote::address(std::chrono::milliseconds limit) const
{
    const auto result = run_command({"ssh", "-G", "--", ssh_}, limit);
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);)
        if (constexpr std::string_view key = "hostname "; line.starts_with(key))
            return line.substr(key.size());
    return host();
}

/// Never prompts: there may be no user. Connections are shared at a path of our own, so that the user's own sharing
/// does not interfere.
std::vector<std::string> Remote::command(const std::vector<std::string>& words) const
{
    std::string line = "hivectl";
    for (const auto& word : words)
        line += " " + quoted_for_shell(word);
    std::vector<std::string> all{"ssh", "-oBatchMode=yes", "-oConnectTimeout=10"};
    if (const auto path = control_path(home_); !path.empty())
        all.insert(all.end(), {"-oControlMaster=auto", "-oControlPersist=60", "-oControlPath=" + path});
    all.insert(all.end(), {"--", ssh_, line});
    return all;
}

void Remote::require_there(const CommandResult& result) const
{
    if (result.late)
        throw Error(Errc::timeout, ssh_ + " has not answered in time", "allow more time: --timeout SECONDS");
    if (result.exit_code == ssh_failed)
        throw Error(Errc::unreachable, "ssh does not reach " + ssh_ + ": " + last_line(result.err),
                    "try it: ssh " + ssh_ + " true");
    if (result.exit_code == no_hivectl)
        throw Error(Errc::not_found,
                    "there is no hivectl on " + ssh_
                        + ", or not in the PATH of a command over ssh: " + last_line(result.err),
                    "install Hive there; see what ssh finds: ssh " + ssh_ + " 'command -v hivectl; echo $PATH'");
}

Error Remote::error_of(const CommandResult& result) const
{
    const auto error = failure_in(result.err).value_or(Error(errc_of_exit(result.exit_code), last_line(result.err)));
    return error.reworded(host() + ": " + error.what());
}

std::string Remote::met_at(const std::vector<std::string>& places, const std::string& address) const
{
    for (const auto& place : places) {
        if (!place.starts_with("tcp://"))
            continue;
        auto met = transport::parse_address(place);
        if (met.is_everywhere())
            met.host = address;
        return to_text(met);
    }
    throw Error(Errc::failed, "the drone on " + host() + " listens at no port", "add --listen tcp://0.0.0.0");
}

CommandResult Remote::hivectl(const std::vector<std::string>& words, std::chrono::milliseconds limit) const
{
    auto result = run_command(command(words), limit);
    require_there(result);
    return result;
}

int Remote::hivectl_attached(const std::vector<std::string>& words) const
{
    const int code = run_attached(command(words));
    if (code == ssh_failed || code == no_hivectl)
        require_there({.exit_code = code, .out = {}, .err = "see above"});
    return code;
}

}  // namespace hive
