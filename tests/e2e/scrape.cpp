// A real Prometheus scrapes a swarm, with the configuration that libhive/docs/metrics.md shows.
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>
#include <possible.hpp>

#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr int workers = 48, sources = 16;

class Prometheus {
public:
    Prometheus(const Swarm& swarm, int exporter, const std::string& token)
        : swarm_(swarm), process_(configured(exporter, token), {}, swarm.home() / "prometheus.log")
    {
    }
    /// The value of a query that has one; nothing while it has none.
    [[nodiscard]] std::optional<double> query(const std::string& expression) const
    {
        const auto url = "http://127.0.0.1:" + std::to_string(port_) + "/api/v1/query";
        const auto done =
            swarm_.run({"/usr/bin/curl", "-s", "-m", "10", "--data-urlencode", "query=" + expression, url});
        const auto answer = Json::parse(done.out, nullptr, false);
        if (answer.is_discarded() || answer.value("status", "") != "success")
            return std::nullopt;
        const auto& found = answer.at("data").at("result");
        return found.empty() ? std::nullopt : std::optional(std::stod(found[0].at("value")[1].get<std::string>()));
    }

private:
    std::vector<std::string> configured(int exporter, const std::string& token) const
    {
        std::ofstream(swarm_.home() / "prometheus.token") << token;
        std::ofstream(swarm_.home() / "prometheus.yml")
            << "global: {scrape_interval: 500ms, evaluation_interval: 500ms}\n"
               "rule_files: [" HIVE_SOURCE_DIR "/hivectl/monitoring/hive.rules.yml]\n"
               "scrape_configs:\n"
               "  - job_name: hive\n"
               "    static_configs: [{targets: [\"127.0.0.1:"
            << exporter << "\"]}]\n    authorization: {credentials_file: prometheus.token}\n";
        return {"/usr/bin/prometheus", "--config.file=" + (swarm_.home() / "prometheus.yml").string(),
                "--storage.tsdb.path=" + (swarm_.home() / "prometheus").string(),
                "--web.listen-address=127.0.0.1:" + std::to_string(port_)};
    }

    const Swarm& swarm_;
    int port_ = free_port();
    Process process_;
};

}  // namespace

TEST_CASE("scrape: a real Prometheus reads 64 drones in less than 100 ms, and sees one that dies")
{
    if (!possible(std::filesystem::exists("/usr/bin/prometheus") ? missing_if_sanitized() : "prometheus"))
        return;
    const Swarm swarm;
    const auto file = swarm.home() / "many.json";
    std::ofstream(file) << Json{
        {"swarm", "many"},
        {"drones",
         {{"source", {{"kind", "ticker"}, {"count", sources}}}, {"worker", {{"kind", "sleeper"}, {"count", workers}}}}},
        {"connections",
         {{{"from", "source-1"}, {"to", "worker-*"}}, {{"from", "source-2"}, {"to", "worker-*"}, {"share", true}}}}};
    swarm.hivectl_done({"up", file.string()}, 60'000ms);
    std::ofstream(swarm.home() / "token") << "secret\n";
    const int port = free_port();
    const auto exporter = swarm.hivectl_running(
        {"metrics", "--http", std::to_string(port), "--token-file", (swarm.home() / "token").string()}, "metrics");
    const Prometheus prometheus(swarm, port, "secret");
    const auto seen = [&] { return prometheus.query("count_over_time(hive_scrape_duration_seconds[1m])"); };
    REQUIRE_MESSAGE(eventually([&] { return seen().value_or(0) >= 10; }, 30'000ms), swarm.log("prometheus"));
    CHECK(prometheus.query("sum(hive_drone_up)") == sources + workers);
    CHECK(prometheus.query("count(hive_connection_came_events_total)") == 2 * workers);
    CHECK(prometheus.query("quantile_over_time(0.5, scrape_duration_seconds[1m])").value_or(1) < 0.1);
    CHECK(prometheus.query("count(ALERTS)") == std::nullopt);
    swarm.run(
        {"/bin/bash", "-c", "kill -9 $(hivectl ps worker-7 --json | grep -o '\"pid\": *[0-9]*' | grep -o '[0-9]*')"});
    CHECK(eventually([&] { return prometheus.query("hive_drone_up{drone=\"worker-7\"}") == 0; }, 10'000ms));
    CHECK(eventually([&] { return prometheus.query("count(ALERTS{alertname=\"HiveDroneDown\"})") == 1; }, 10'000ms));
}
