// Answers scrapers with the metrics of a swarm.
#pragma once

#include <hive/application.hpp>
#include <hive/http/server.hpp>
#include <hive/metrics.hpp>

namespace hivectl {

/// Asks the drones on the thread of its server: the next scraper waits as long as one answer takes, which the timeout
/// of the application limits.
class MetricsSite final : public hive::http::Site {
public:
    /// @param application  used by nobody else as long as there is a server
    /// @param open  whether no token is needed; then only a request whose host is an address of this server is
    /// answered, so that no page of another site can read
    MetricsSite(hive::Application& application, bool open) : application_(application), open_(open) {}

private:
    std::optional<hive::http::Answer> answer(const hive::http::Request& request, hive::http::Visit& visit) override;
    [[nodiscard]] std::optional<hive::http::Answer> refusal(const hive::http::Request& request,
                                                            const hive::http::Visit& visit) const;
    const hive::Metrics& newest(hive::http::Clock::time_point now);

    hive::Application& application_;
    const bool open_;
    hive::Metrics newest_;
    hive::http::Clock::time_point asked_{};
};

}  // namespace hivectl
