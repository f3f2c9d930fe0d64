// Answers scrapers with the metrics of a swarm.
#pragma once

#include <hive/application.hpp>
#include <hive/http/server.hpp>
#include <hive/metrics.hpp>

namespace hivectl {

/// Queries the drones on the thread of its server, so the next scraper waits for that, at most the application's
/// timeout.
class MetricsSite final : public hive::http::Site {
public:
    /// @param application  not used elsewhere while there is a server
    /// @param open         no token is needed. At a loopback address the host of a request must then be an address of
    ///                     this server, so that no page of another site can read.
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
