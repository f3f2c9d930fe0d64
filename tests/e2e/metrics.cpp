// hivectl metrics: the metrics for Prometheus, printed and over HTTP, match the counters of the drones.
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>
#include <possible.hpp>

#include <csignal>
#include <fstream>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

/// The value of a sample; nothing if there is none.
std::optional<double> value(const std::string& text, const std::string& sample)
{
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (line.starts_with(sample + " "))
            return std::stod(line.substr(sample.size() + 1));
    return std::nullopt;
}

/// A source, a receiver and a group, with skipped events, exceptions and an application.
struct Busy {
    Busy()
    {
        application.connect({"source", ""}, {"plain", ""});
        for (const auto* member : {"one", "two"})
            application.connect({"source", ""}, {member, ""}, {.window = 2, .group = "workers", .lease = {}});
        REQUIRE(eventually([&] { return application.status("thrower").state == hive::State::idle; }));
        application.connect({"source", ""}, {"thrower", ""});
        REQUIRE(eventually([&] { return application.status("thrower").last_exception.has_value(); }));
        REQUIRE(eventually([&] { return application.status("one").busy_us > 0; }));
    }
    Swarm swarm;
    Process source = swarm.drone("ticker", "source", {"fps=200"}),
            plain = swarm.drone("sleeper", "plain", {"work_ms=20"}), one = swarm.drone("sleeper", "one"),
            two = swarm.drone("sleeper", "two"), thrower = swarm.drone("sleeper", "thrower", {"throw_at=1"});
    hive::Application application = swarm.application();

    [[nodiscard]] std::string metrics(const std::string& form = "prometheus") const
    {
        return swarm.hivectl_done({"metrics", "--as", form});
    }
};

/// Checks that each counter of a text of OpenMetrics is at least what it was, unless its drone started since.
/// @param last  the values and times before; gets those of the text
/// @return      the counters that began again
int check_counters(const std::string& text, std::map<std::string, double>& last)
{
    std::map<std::string, double> now;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with("#") && (has(line, "_total{") || has(line, "_created{")))
            now[line.substr(0, line.rfind(' '))] = std::stod(line.substr(line.rfind(' ')));
    int again = 0;
    for (const auto& [sample, number] : now)
        if (const auto total = sample.find("_total{"); total != std::string::npos && number < last[sample]) {
            const auto start = sample.substr(0, total) + "_created" + sample.substr(total + 6);
            CHECK_MESSAGE(now[start] > last[start], sample, ": ", last[sample], " and then ", number);
            ++again;
        }
    for (const auto& [sample, number] : now)
        last[sample] = number;
    return again;
}

/// hivectl metrics --http, and curl.
class Scraped {
public:
    Scraped(const Swarm& swarm, const std::vector<std::string>& more = {}, const std::string& address = "")
        : swarm_(swarm), server_(swarm.hivectl_running(words(address, more), log_name()))
    {
        REQUIRE(eventually([&] { return has(swarm_.log(log_name()), "/metrics\n"); }));
    }
    /// Prints the body, then "CODE TYPE".
    [[nodiscard]] std::string get(const std::string& path, const std::vector<std::string>& headers = {}) const
    {
        std::vector<std::string> line{"/usr/bin/curl", "-sS", "-m", "10", "-w", "%{http_code} %{content_type}"};
        for (const auto& header : headers)
            line.insert(line.end(), {"-H", header});
        line.push_back("http://127.0.0.1:" + std::to_string(port_) + path);
        const auto done = swarm_.run(line);
        CHECK_MESSAGE(done.exit_code == 0, done.err);
        return done.out;
    }

    /// The exit code after SIGTERM, as systemd sends it.
    std::optional<int> stop()
    {
        server_.signal(SIGTERM);
        return server_.wait(patient(5'000ms));
    }

private:
    [[nodiscard]] std::string log_name() const { return "metrics-" + std::to_string(port_); }
    [[nodiscard]] std::vector<std::string> words(const std::string& address, const std::vector<std::string>& more) const
    {
        std::vector<std::string> all{"metrics", "--http", address + std::to_string(port_)};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
    const Swarm& swarm_;
    int port_ = free_port();
    Process server_;
};

std::string missing_program(const Swarm& swarm, const std::string& test, const std::string& name)
{
    return swarm.run({"/bin/bash", "-c", test}).exit_code == 0 ? "" : name;
}

}  // namespace

TEST_CASE(
    "metrics: promtool and the parser of OpenMetrics read a busy swarm, and find all that rules and dashboard name")
{
    const Busy busy;
    const auto missing =
        missing_program(busy.swarm, "command -v promtool", "promtool, of the package prometheus")
        + missing_program(busy.swarm, "/usr/bin/python3 -c 'import prometheus_client.openmetrics.parser'",
                          "python3-prometheus-client");
    if (!possible(missing))
        return;
    const std::string tests = HIVE_SOURCE_DIR "/tests/monitoring/", files = HIVE_SOURCE_DIR "/hivectl/monitoring/";
    const auto read = busy.swarm.run({"/bin/bash", "-c",
                                      "set -eo pipefail; cd $HIVE_HOME; hivectl metrics | promtool check metrics; "
                                      "hivectl metrics --as openmetrics | "
                                      "/usr/bin/python3 "
                                          + tests + "read_metrics.py " + files + "hive.rules.yml " + files
                                          + "grafana.json > queries.yml; promtool check rules queries.yml"},
                                     patient(15'000ms));
    CHECK_MESSAGE(read.exit_code == 0, read.out, read.err);
    CHECK_EQ(read.err, "");
}

TEST_CASE("metrics: the numbers are those of hivectl connections, and sums balance while events pass")
{
    const Busy busy;
    const auto row = R"({sender="source",output="tick",receiver="plain",input="image",group="")";
    for (int round = 0; round < 5; ++round) {
        const auto text = busy.metrics();
        double settled = 0;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with(std::string("hive_connection_settled_events_total") + row))
                settled += std::stod(line.substr(line.rfind(' ')));
        const auto came = value(text, std::string("hive_connection_came_events_total") + row + "}");
        REQUIRE_MESSAGE(came, text);
        CHECK(*came == settled + *value(text, std::string("hive_connection_in_flight_events") + row + "}"));
    }
    CHECK(*value(busy.metrics(), R"(hive_drone_exceptions_total{drone="thrower"})") >= 1);
    busy.swarm.hivectl_done({"halt", "source"});
    const auto came_now = [&] {
        return value(busy.metrics(), std::string("hive_connection_came_events_total") + row + "}");
    };
    REQUIRE(eventually(
        [&] { return value(busy.metrics(), R"(hive_drone_state{drone="source",hive_drone_state="halted"})") == 1; }));
    for (const auto& connection : Json::parse(busy.swarm.hivectl_done({"connections", "--json"})))
        if (connection.at("to") == "plain.image")
            CHECK(connection.at("came").get<double>() == came_now());
}

TEST_CASE("metrics: a drone that is killed or hangs is down, and what it counts begins again with its start")
{
    Busy busy;
    const auto start = *value(busy.metrics(), R"(hive_drone_start_time_seconds{drone="one"})");
    const auto before = busy.metrics("openmetrics");
    const std::string sample = R"({drone="one",input="image"})";
    CHECK(value(before, "hive_input_received_events_created" + sample) == doctest::Approx(start).epsilon(1e-12));
    busy.one.kill();
    busy.two.signal(SIGSTOP);
    const auto began = std::chrono::steady_clock::now();
    const auto text = busy.metrics();
    CHECK(std::chrono::steady_clock::now() - began
          < patient(3'000ms));  // hivectl metrics waits 1 s for the missing answer
    for (const auto& [drone, up] : {std::pair{"source", 1}, std::pair{"one", 0}, std::pair{"two", 0}})
        CHECK_MESSAGE(value(text, "hive_drone_up{drone=\"" + std::string(drone) + "\",host=\"local\"}") == up, text);
    CHECK_FALSE(value(text, R"(hive_drone_start_time_seconds{drone="two"})"));
    busy.two.signal(SIGCONT);
    const auto again = busy.swarm.drone("sleeper", "one");
    REQUIRE(
        eventually([&] { return value(busy.metrics(), "hive_input_received_events_total" + sample).value_or(0) > 0; }));
    const auto after = busy.metrics("openmetrics");
    CHECK(*value(after, "hive_input_received_events_created" + sample) > start + 0.001);
    CHECK(value(after, R"(hive_drone_up{drone="one",host="local"})") == 1);
}

TEST_CASE("metrics: within one run of a drone no counter goes back, while connections come and go")
{
    Busy busy;
    std::map<std::string, double> last;
    for (int round = 0; round < 12; ++round) {
        if (round % 3 == 1)
            busy.application.disconnect({"source", ""}, {"plain", ""});
        if (round % 3 == 2)
            busy.application.connect({"source", ""}, {"plain", ""});
        std::istringstream lines(busy.metrics());
        for (std::string line; std::getline(lines, line);) {
            const auto space = line.rfind(' ');
            if (line.starts_with("#") || !has(line, "_total{"))
                continue;
            const auto sample = line.substr(0, space);
            const auto now = std::stod(line.substr(space));
            CHECK_MESSAGE(now >= last[sample], sample, " round ", round);
            last[sample] = now;
        }
    }
    CHECK(last.size() > 50);
}

TEST_CASE("metrics: while drones are replaced each scrape has all of them, and a counter goes back only with its drone")
{
    Busy busy;
    const Scraped scraped(busy.swarm, {"--timeout", "9"});
    const auto replace = [&](const std::string& drone) {
        return busy.swarm.hivectl_running({"replace", drone, "--timeout", "50"}, "replace");
    };
    std::map<std::string, double> last;
    int backwards = 0, scrapes = 0;
    for (const std::string drone : {"plain", "one", "two", "source", "plain", "one"}) {
        const auto before = busy.application.status(drone).pid;
        auto replacing = replace(drone);
        bool over = false;
        const auto end = std::chrono::steady_clock::now() + patient(60'000ms);
        for (std::optional<int> code; !std::exchange(over, code.has_value()); code = replacing.wait(0ms), ++scrapes) {
            REQUIRE(std::chrono::steady_clock::now() < end);
            CAPTURE(drone);
            const auto text = scraped.get("/metrics", {"Accept: application/openmetrics-text;version=1.0.0"});
            REQUIRE_MESSAGE(has(text, "# EOF\n200 "), text);
            for (const std::string each : {"source", "plain", "one", "two", "thrower"})
                CHECK_MESSAGE(value(text, "hive_drone_up{drone=\"" + each + "\",host=\"local\"}") == 1, text);
            backwards += check_counters(text, last);
            if (code)
                CHECK_MESSAGE(code == 0, busy.swarm.log("replace"));
        }
        CHECK(busy.application.status(drone).pid != before);
    }
    MESSAGE(scrapes, " scrapes");
    CHECK(last.size() > 100);
    CHECK(backwards > 0);  // those of the replaced drones
}

TEST_CASE("metrics: over HTTP the scraper chooses the form, and pages of other sites read nothing")
{
    const Busy busy;
    Scraped scraped(busy.swarm);
    const auto plain = scraped.get("/metrics");
    CHECK(plain.ends_with("\n200 text/plain; version=0.0.4; charset=utf-8"));
    CHECK(has(plain, "hive_drone_up{drone=\"source\",host=\"local\"} 1\n"));
    const auto open = scraped.get("/metrics", {"Accept: application/openmetrics-text;version=1.0.0,text/plain;q=0.5"});
    CHECK(open.ends_with("# EOF\n200 application/openmetrics-text; version=1.0.0; charset=utf-8"));
    CHECK(scraped.get("/").ends_with("\n200 text/plain; charset=utf-8"));
    CHECK(scraped.get("/x").ends_with("\n404 text/plain; charset=utf-8"));
    CHECK(has(scraped.get("/metrics", {"Host: evil.example"}), "403"));
    CHECK(has(scraped.get("/metrics", {"Sec-Fetch-Site: cross-site"}), "403"));
    CHECK(scraped.stop() == 143);  // a success for the unit that is installed
    CHECK(has(text_of(HIVE_SOURCE_DIR "/hivectl/monitoring/hive-metrics.service"), "SuccessExitStatus=143\n"));
}

TEST_CASE("metrics: other machines read only with the token, unless all may")
{
    const Swarm swarm;
    const auto refused = swarm.hivectl({"metrics", "--http", "0.0.0.0:" + std::to_string(free_port())});
    CHECK(refused.exit_code == 5);
    CHECK(has(refused.err, "0.0.0.0 is reachable from other machines"));
    const auto file = swarm.home() / "token";
    std::ofstream(file) << "secret\n";
    const Scraped scraped(swarm, {"--token-file", file.string()}, "0.0.0.0:");
    CHECK(has(scraped.get("/metrics"), "401"));
    CHECK(has(scraped.get("/metrics", {"Authorization: Bearer wrong"}), "401"));
    CHECK(has(scraped.get("/metrics?token=secret"), "401"));  // proxies log addresses
    CHECK(has(scraped.get("/metrics", {"Authorization: Bearer secret", "Host: metrics:9464"}), "\n200 text/plain"));
    const Scraped insecure(swarm, {"--insecure"}, "0.0.0.0:");
    CHECK(has(insecure.get("/metrics", {"Host: metrics:9464"}), "\n200 text/plain"));
    std::ofstream(file).close();
    const auto empty = swarm.hivectl({"metrics", "--http", "9464", "--token-file", file.string()});
    CHECK(empty.exit_code == 2);
    CHECK(has(empty.err, "no token"));
    for (const auto* address : {"x", "127.0.0.1", "1:2:3", "70000", "localhost:9464", ":9464"})
        CHECK_MESSAGE(swarm.hivectl({"metrics", "--http", address}).exit_code != 0, address);
}

TEST_CASE("metrics: drones of other machines are found by the places that a container is given")
{
    const Swarm there, here;
    const auto address = "tcp://127.0.0.1:" + std::to_string(free_port());
    const auto source = there.drone("ticker", "source", {}, {"--listen", address, "--insecure"});
    const auto nowhere = "gone=tcp://127.0.0.1:" + std::to_string(free_port());
    for (int round = 0; round < 2; ++round) {  // a container that restarts writes the same again
        const auto text = here.hivectl_done({"metrics", "--place", "source=" + address, "--place", nowhere});
        CHECK_MESSAGE(value(text, R"(hive_drone_up{drone="source",host="127.0.0.1"})") == 1, text);
        CHECK(value(text, R"(hive_drone_up{drone="gone",host="127.0.0.1"})") == 0);
    }
    CHECK(here.hivectl({"metrics", "--place", "source"}).exit_code != 0);
}
