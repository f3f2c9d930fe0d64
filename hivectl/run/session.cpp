// The values of the common flags, and the lazily created application.
#include "run/session.hpp"

#include "words/exit_code.hpp"

namespace hivectl {

std::chrono::milliseconds Session::timeout(std::chrono::milliseconds fallback) const
{
    return timeout_s ? std::chrono::milliseconds(static_cast<std::int64_t>(*timeout_s * 1000)) : fallback;
}

hive::Application& Session::application(std::chrono::milliseconds fallback)
{
    if (application_)
        return *application_;
    waiting_.emplace("drones to answer", Waiting::Turn::first);
    application_ = std::make_unique<hive::Application>(hive::Application::Options{
        .name = {}, .home = home(), .timeout = timeout(fallback), .advice_if_missing = advice_for_missing});
    return *application_;
}

std::filesystem::path Session::home() const { return std::filesystem::absolute(hive::default_home()); }

}  // namespace hivectl
