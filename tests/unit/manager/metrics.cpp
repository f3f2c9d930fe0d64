// What is scraped: both text forms to the letter, and samples that can be summed.
#include <hive/audit.hpp>
#include <hive/metrics.hpp>

#include <doctest/doctest.h>

#include <algorithm>

using namespace hive;
using Type = MetricFamily::Type;

namespace {

constexpr std::int64_t epoch = 1'700'000'000'250'000;

const MetricFamily* family(const Metrics& all, const std::string& name)
{
    const auto found = std::ranges::find(all, name, &MetricFamily::name);
    return found == all.end() ? nullptr : &*found;
}

/// The sum of all samples that have these labels.
double sum(const Metrics& all, const std::string& name, const std::vector<std::pair<std::string, std::string>>& labels)
{
    double total = 0;
    const auto* found = family(all, name);
    REQUIRE_MESSAGE(found, name);
    for (const auto& sample : found->samples)
        if (std::ranges::all_of(labels, [&](const auto& label) {
                return std::ranges::find(sample.labels, label) != sample.labels.end();
            }))
            total += sample.value;
    return total;
}

EdgeStatus edge(const std::string& receiver, std::int64_t came, std::int64_t acknowledged)
{
    EdgeStatus result{.receiver = receiver, .connected = true};
    result.events.came(came);
    result.events.went(Fate::acknowledged, acknowledged);
    return result;
}

StatusAnswer answer(Status status)
{
    const auto name = status.name;
    return {.drone = name,
            .status = std::move(status),
            .place = {.drone = name, .host = Place::here, .address = "unix:/x"}};
}

/// A camera with a receiver, a group of two and an application.
StatusAnswer camera()
{
    auto group = edge("group faces", 100, 90);
    group.group = true;
    auto one = edge("face-1.image", 60, 50), two = edge("face-2.image", 50, 40);
    one.options.group = two.options.group = "faces";
    two.connected = false;
    Status status{.name = "camera", .kind = "camera", .epoch = epoch, .state = State::busy, .busy_us = 1'500'000};
    status.outputs.push_back({.name = "image",
                              .type = "image/raw",
                              .produced = 120,
                              .edges = {edge("view.image", 120, 117), group, one, two, edge("app-77", 9, 9)}});
    status.outputs.push_back({.name = "exceptions", .type = {}, .produced = 4});
    return answer(status);
}

}  // namespace

TEST_CASE("metrics: the text form 0.0.4, to the letter")
{
    const Metrics all{
        {.name = "hive_x_events",
         .type = Type::counter,
         .unit = "events",
         .help = "A \"quote\", a \\ and\na line.",
         .samples = {{{{"drone", "a \"b\" \\ c\nd"}, {"fate", ""}}, 3, epoch},
                     {{{"drone", "e"}, {"fate", "x"}}, 9e15}}},
        {.name = "hive_y_seconds", .type = Type::gauge, .unit = "seconds", .help = "Y.", .samples = {{{}, 0.1}}},
        {.name = "hive_z", .type = Type::info, .help = "Z.", .samples = {{{{"kind", "k"}}, 1}}},
        {.name = "hive_s",
         .type = Type::state,
         .help = "S.",
         .samples = {{{{"hive_s", "on"}}, 1}, {{{"hive_s", "off"}}, 0}}}};
    CHECK(to_text(all, MetricsForm::prometheus)
          == "# TYPE hive_x_events_total counter\n"
             "# HELP hive_x_events_total A \"quote\", a \\\\ and\\na line.\n"
             "hive_x_events_total{drone=\"a \\\"b\\\" \\\\ c\\nd\",fate=\"\"} 3\n"
             "hive_x_events_total{drone=\"e\",fate=\"x\"} 9000000000000000\n"
             "# TYPE hive_y_seconds gauge\n"
             "# HELP hive_y_seconds Y.\n"
             "hive_y_seconds 0.1\n"
             "# TYPE hive_z_info gauge\n"
             "# HELP hive_z_info Z.\n"
             "hive_z_info{kind=\"k\"} 1\n"
             "# TYPE hive_s gauge\n"
             "# HELP hive_s S.\n"
             "hive_s{hive_s=\"on\"} 1\n"
             "hive_s{hive_s=\"off\"} 0\n");
    CHECK(to_text(all, MetricsForm::openmetrics)
          == "# TYPE hive_x_events counter\n"
             "# UNIT hive_x_events events\n"
             "# HELP hive_x_events A \\\"quote\\\", a \\\\ and\\na line.\n"
             "hive_x_events_total{drone=\"a \\\"b\\\" \\\\ c\\nd\",fate=\"\"} 3\n"
             "hive_x_events_created{drone=\"a \\\"b\\\" \\\\ c\\nd\",fate=\"\"} 1700000000.250000\n"
             "hive_x_events_total{drone=\"e\",fate=\"x\"} 9000000000000000\n"
             "# TYPE hive_y_seconds gauge\n"
             "# UNIT hive_y_seconds seconds\n"
             "# HELP hive_y_seconds Y.\n"
             "hive_y_seconds 0.1\n"
             "# TYPE hive_z info\n"
             "# HELP hive_z Z.\n"
             "hive_z_info{kind=\"k\"} 1\n"
             "# TYPE hive_s stateset\n"
             "# HELP hive_s S.\n"
             "hive_s{hive_s=\"on\"} 1\n"
             "hive_s{hive_s=\"off\"} 0\n"
             "# EOF\n");
}

TEST_CASE("metrics: as JSON")
{
    const Metrics all{{.name = "hive_x_events",
                       .type = Type::counter,
                       .unit = "events",
                       .help = "X.",
                       .samples = {{{{"drone", "a"}}, 3, epoch}}},
                      {.name = "hive_y", .type = Type::gauge, .help = "Y.", .samples = {{{}, 0.5}}}};
    CHECK(to_json(all) == Json::parse(R"([
              {"name": "hive_x_events", "type": "counter", "unit": "events", "help": "X.",
               "samples": [{"labels": {"drone": "a"}, "value": 3.0, "created_us": 1700000000250000}]},
              {"name": "hive_y", "type": "gauge", "help": "Y.", "samples": [{"labels": {}, "value": 0.5}]}])"));
}

TEST_CASE("metrics: OpenMetrics for a scraper that knows it, with the exact type")
{
    CHECK(metrics_form("") == MetricsForm::prometheus);
    CHECK(metrics_form("text/html, */*;q=0.8") == MetricsForm::prometheus);
    CHECK(metrics_form("application/openmetrics-text;version=1.0.0,text/plain;version=0.0.4;q=0.5")
          == MetricsForm::openmetrics);
    CHECK(media_type(MetricsForm::prometheus) == "text/plain; version=0.0.4; charset=utf-8");
    CHECK(media_type(MetricsForm::openmetrics) == "application/openmetrics-text; version=1.0.0; charset=utf-8");
}

TEST_CASE("metrics: each sum over all labels counts every event once")
{
    const auto all = metrics({camera()});
    CHECK(sum(all, "hive_output_emitted_events", {}) == 120);  // exceptions are no results
    CHECK(sum(all, "hive_drone_exceptions", {{"drone", "camera"}}) == 4);
    CHECK(sum(all, "hive_connection_came_events", {}) == 120 + 60 + 50);  // the group is another family
    CHECK(sum(all, "hive_connection_came_events", {{"receiver", "face-1"}, {"input", "image"}, {"group", "faces"}})
          == 60);
    CHECK(sum(all, "hive_group_came_events", {{"sender", "camera"}, {"output", "image"}, {"group", "faces"}}) == 100);
    CHECK(sum(all, "hive_group_members", {}) == 1);
    CHECK(sum(all, "hive_output_applications", {{"output", "image"}}) == 1);
    for (const std::string subject : {"hive_connection", "hive_group"})
        CHECK(sum(all, subject + "_came_events", {})
              == sum(all, subject + "_settled_events", {}) + sum(all, subject + "_in_flight_events", {}));
    CHECK(family(all, "hive_connection_settled_events")->samples.size() == 3 * fates);  // those that are 0 as well
    CHECK(sum(all, "hive_drone_busy_seconds", {}) == 1.5);
    CHECK(sum(all, "hive_drone_state", {}) == 1);
    CHECK(sum(all, "hive_drone_state", {{"hive_drone_state", "busy"}}) == 1);
}

TEST_CASE("metrics: the events lost are those that audit calls lost, at each end, and 0 before the first")
{
    auto one = edge("face.image", 10'000, 0);
    std::int64_t lost = 0;
    for (std::size_t i = 0; i < fates; ++i) {
        one.events.went(static_cast<Fate>(i), 1 << i);
        lost += is_loss(static_cast<Fate>(i)) ? 1 << i : 0;
    }
    auto group = one;
    group.receiver = "group faces";
    group.group = true;
    Status sender{.name = "camera", .kind = "camera", .epoch = epoch}, receiver{.name = "face", .kind = "face"};
    sender.outputs.push_back({.name = "image", .type = {}, .edges = {one, group}});
    receiver.inputs = receiver.left = {{.input = "image",
                                        .received = 62,
                                        .processed = 2,
                                        .abandoned = 4,
                                        .duplicates = 8,
                                        .discarded = 16,
                                        .dropped = 32}};
    receiver.inputs[0].from = "camera.image";
    const std::vector answers{answer(sender), answer(receiver)};
    const auto all = metrics(answers);
    const char* const name = "hive_audit_lost_events";
    CHECK(sum(all, name, {{"drone", "camera"}, {"port", "image"}, {"peer", "face.image"}}) == lost);
    CHECK(sum(all, name, {{"drone", "camera"}, {"port", "image"}, {"peer", "group faces"}}) == lost);
    CHECK(sum(all, name, {{"drone", "face"}, {"port", "image"}, {"peer", ""}}) == 2 * 36);
    std::int64_t by_audit = 0;
    for (const auto& row : audit(answers, answers, answers).rows)
        by_audit += row.lost();
    CHECK(sum(all, name, {}) == by_audit);
    CHECK(family(all, name)->samples.size() == 3);
    CHECK(family(all, name)->samples[0].created_us == epoch);
    const auto calm = metrics({camera()});  // an alert sees the first loss only if the counter was there before
    CHECK(family(calm, name)->samples.size() == 4);
    CHECK(sum(calm, name, {}) == 0);
}

TEST_CASE("metrics: a drone has its version as a label")
{
    CHECK(sum(metrics({answer({.name = "face", .kind = "face", .version = "0.2.0"})}), "hive_drone",
              {{"drone", "face"}, {"version", "0.2.0"}})
          == 1);
}

TEST_CASE("metrics: no name that an application chooses, or that is new each time, is a label")
{
    CHECK(to_text(metrics({camera()}), MetricsForm::openmetrics).find("app-77") == std::string::npos);
}

TEST_CASE("metrics: what an input has received does not go back when a connection ends or begins again")
{
    const InputStatus row{
        .input = "image", .from = "camera.image", .connected = true, .received = 7, .processed = 6, .queued = 1};
    Status before{.name = "face", .kind = "face", .epoch = epoch};
    before.inputs = {row};
    Status after = before;
    after.left = {row};  // which has been disconnected, and connected again
    after.inputs[0].received = after.inputs[0].processed = 2;
    after.inputs[0].queued = after.left[0].queued = 0;
    after.left[0].processed = 7;
    const auto first = metrics({answer(before)}), second = metrics({answer(after)});
    CHECK(sum(first, "hive_input_received_events", {{"drone", "face"}, {"input", "image"}}) == 7);
    CHECK(sum(second, "hive_input_received_events", {{"drone", "face"}, {"input", "image"}}) == 9);
    CHECK(sum(second, "hive_input_settled_events", {{"fate", "processed"}}) == 9);
    CHECK(family(second, "hive_input_received_events")->samples.size() == 1);
    CHECK(family(second, "hive_input_received_events")->samples[0].created_us == epoch);
}

TEST_CASE("metrics: a drone that does not answer, or crashed, is down, and has no other sample")
{
    StatusAnswer silent{.drone = "face",
                        .status = Error(Errc::timeout, "no answer"),
                        .place = {.drone = "face", .host = "cam1", .address = "tcp://cam1:7700"}};
    const auto all = metrics({camera(), silent}, {"track"});
    CHECK(sum(all, "hive_drone_up", {{"drone", "camera"}}) == 1);
    REQUIRE(family(all, "hive_drone_up")->samples.size() == 3);
    CHECK(sum(all, "hive_drone_up", {}) == 1);
    CHECK(sum(all, "hive_drone_up", {{"drone", "face"}, {"host", "cam1"}}) == 0);
    CHECK(family(all, "hive_drone")->samples.size() == 1);
}
