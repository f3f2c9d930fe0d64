// A drone was ready when it was reported, since the hivectl on its machine waits for that.
#include "ssh_silent.hpp"

#include <algorithm>
#include <iterator>

namespace hive {
namespace {

using namespace std::chrono_literals;

constexpr auto check_timeout = 10s;
constexpr auto check_interval = 1s;
constexpr const char* log_lines = "15";

}  // namespace

void SilentDrones::check(const std::string& drone, const Error& why)
{
    const auto now = Clock::now();
    auto& silent = silent_.try_emplace(drone, Silent{.why = why}).first->second;
    silent.why = why;
    if (now < silent.next_check || checks_.size() + logs_.size() >= SshSession::max_of_connection
        || SshSession::is_limit_reached())
        return;
    silent.next_check = now + check_timeout + check_interval;
    checks_.emplace_back(drone, remote_.command({"ps", drone}), check_timeout);
}

void SilentDrones::poll(std::vector<Engine::Report>& reports)
{
    std::erase_if(checks_, [&](SshSession& check) {
        const auto result = check.command.poll();
        if (result && !result->late && is_not_found(*result))
            read_log(check.drone, reports);
        else if (result && !result->late && result->exit_code == 0)
            on_running(check.drone, reports);
        return result.has_value();
    });
    std::erase_if(logs_, [&](SshSession& log) {
        const auto result = log.command.poll();
        if (result)
            reports.push_back(
                {log.drone, Error(Errc::failed, remote_.host() + ": " + log.drone
                                                    + " was ready and has exited since; its log says:\n"
                                                    + (result->out.empty() ? "(nothing)" : result->out))});
        return result.has_value();
    });
}

void SilentDrones::add_descriptors(std::vector<int>& all) const
{
    for (const auto* sessions : {&checks_, &logs_})
        for (const auto& session : *sessions)
            std::ranges::copy(session.command.descriptors(), std::back_inserter(all));
}

/// It may just be exiting there, or one answer may have been late, so it is checked twice.
void SilentDrones::on_running(const std::string& drone, std::vector<Engine::Report>& reports)
{
    auto& [why, found_running, next_check] = silent_.at(drone);
    next_check = Clock::now() + check_interval;
    if (++found_running < 2)
        return;
    reports.push_back(
        {drone, Error(why.code(), drone + " runs on " + remote_.host() + " and is not reached from here: " + why.what(),
                      why.advice().empty() ? "open its port to this machine, or choose one that is open: \"listen\""
                                           : why.advice())});
}

void SilentDrones::read_log(const std::string& drone, std::vector<Engine::Report>& reports)
try {
    logs_.emplace_back(drone, remote_.command({"logs", drone, "-n", log_lines}), check_timeout);
} catch (const Error& error) {
    reports.push_back({drone, error});
}

}  // namespace hive
