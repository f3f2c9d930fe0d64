// What the page of hivectl dash shows, and the images that it gets, without drones and browsers.
#include "dash/jpeg.hpp"
#include "dash/layout.hpp"
#include "dash/snapshot.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

#include <turbojpeg.h>

using namespace hivectl::dash;
using hive::Json;
using namespace std::chrono_literals;

namespace {

hive::StatusAnswer source_of(std::int64_t events, std::int64_t dropped)
{
    hive::EdgeStatus edge{.receiver = "worker.image", .connected = true, .registration = 7};
    edge.events.came(events);
    edge.events.went(hive::Fate::acknowledged, events - dropped);
    edge.events.went(hive::Fate::dropped, dropped);
    hive::Status status{.name = "source", .kind = "camera", .epoch = 1, .state = hive::State::idle};
    status.uptime_us = events * 1000;
    status.outputs.push_back({.name = "image", .type = "image/jpeg,image/raw", .produced = events, .edges = {edge}});
    return {"source", status, {.drone = "source", .host = "local", .address = "unix:/source"}};
}

hive::Status& status_in(hive::StatusAnswer& answer) { return std::get<hive::Status>(answer.status); }

hive::StatusAnswer worker_of(std::int64_t events, std::int64_t exceptions)
{
    hive::Status status{.name = "worker", .kind = "face", .epoch = 1, .state = hive::State::halted};
    status.inputs.push_back({.input = "image",
                             .from = "source.image",
                             .connected = true,
                             .registration = 7,
                             .received = events,
                             .processed = events});
    if (exceptions > 0)
        status.last_exception = {.code = "failed", .text = "no face", .time_us = exceptions};
    return {"worker", status, {.drone = "worker", .host = "local", .address = "unix:/worker"}};
}

Look look(std::int64_t events, std::int64_t dropped, std::int64_t exceptions, std::chrono::seconds at)
{
    return {{source_of(events, dropped), worker_of(events - dropped, exceptions)},
            std::chrono::steady_clock::time_point(at)};
}

Snapshot snapshot(const std::array<Look, 3>& looks) { return snapshot_of(looks, hive::graph(looks[2].answers)); }

hive::Event raw(int width, int height, const std::string& format, std::size_t channels, unsigned char value = 200)
{
    hive::Event event;
    event.type = "image/raw";
    event.header = {{"width", width}, {"height", height}, {"pixel_format", format}};
    event.body = hive::Body(std::string(static_cast<std::size_t>(width * height) * channels, static_cast<char>(value)));
    return event;
}

std::pair<int, int> size_of(const Image& image)
{
    void* const handle = tjInitDecompress();
    int width = 0, height = 0, sampling = 0, colours = 0;
    CHECK(tjDecompressHeader3(handle, image.bytes.data(), image.bytes.size(), &width, &height, &sampling, &colours)
          == 0);
    tjDestroy(handle);
    return {width, height};
}

hive::Event event_of(const Image& image)
{
    hive::Event event;
    event.type = image.type;
    event.body = hive::Body(image.bytes);
    return event;
}

}  // namespace

TEST_CASE("dash: rows have rates of the last second, and losses of the whole account")
{
    const auto now = snapshot({look(100, 0, 0, 1s), look(130, 1, 0, 2s), look(160, 3, 0, 3s)});
    REQUIRE(now.drones.size() == 2);
    CHECK(now.drones[0].at("out_per_s") == 30.0);
    CHECK(now.drones[0].at("images") == Json{"image"});
    CHECK(now.drones[1].at("state") == "halted");
    REQUIRE(now.edges.size() == 1);
    CHECK(now.edges[0].at("id") == "source.image>worker.image>");
    CHECK(now.edges[0].at("per_s") == 28.0);
    CHECK(now.edges[0].at("lost") == 3);
    CHECK(now.edges[0].at("verdict") == "lost");
    CHECK(now.edges[0].at("losing") == true);
    CHECK(edge_details(now, "source.image>worker.image>").at("counts").at("dropped") == 3);
    CHECK(edge_details(now, "nothing").is_null());
}

TEST_CASE("dash: the bar says what is lost, and how busy machines are")
{
    const std::array<Look, 3> clean{look(100, 0, 0, 1s), look(130, 0, 0, 2s), look(160, 0, 0, 3s)},
        lossy{look(100, 0, 0, 1s), look(130, 1, 0, 2s), look(160, 1, 0, 3s)};
    CHECK(bar_of(clean).at("verdict") == "nothing lost");
    const auto bar = bar_of(lossy);
    CHECK(bar.at("verdict") == "1 event lost");
    CHECK(bar.at("clean") == false);
    CHECK(bar.at("machines") == Json::array({{{"host", "local"}, {"drones", 2}, {"busy_percent", nullptr}}}));

    auto busy = clean;
    for (auto& each : busy)
        status_in(each.answers[0]).machine.processors = 2;
    status_in(busy[2].answers[0]).uptime_us = status_in(busy[1].answers[0]).uptime_us + 1'000'000;
    status_in(busy[2].answers[0]).machine.cpu_us = 1'500'000;
    CHECK(bar_of(busy).at("machines").at(0).at("busy_percent") == 75.0);
}

TEST_CASE("dash: the first look has no rates, and is valid JSON")
{
    const auto only = look(100, 0, 0, 1s);
    const auto now = snapshot({only, only, only});
    CHECK(Json::parse(now.drones.dump()).size() == 2);
    CHECK(now.edges.size() == 1);
}

TEST_CASE("dash: exceptions and rates of a drone are kept, newest exceptions first, and forgotten with the drone")
{
    std::map<std::string, Past> past;
    for (int i = 1; i <= 300; ++i)
        remember(past, snapshot({look(10 * i, 0, 0, 1s), look(10 * i, 0, 0, 2s), look(10 * i + 10, 0, i / 2, 3s)}));
    auto now = snapshot({look(1, 0, 0, 1s), look(1, 0, 0, 2s), look(1, 0, 150, 3s)});
    now.past = past;
    const auto details = drone_details(now, "worker");
    CHECK(details.at("per_s").size() == Past::samples_kept);
    REQUIRE(details.at("exceptions").size() == Past::exceptions_kept);
    CHECK(details.at("exceptions")[0].at("time_us") == 150);
    CHECK(details.at("exceptions")[1].at("time_us") == 149);
    CHECK(drone_details(now, "nobody").is_null());
    now.look.answers.pop_back();
    now.drones.erase(1);
    remember(past, now);
    CHECK(past.size() == 1);
}

TEST_CASE("dash: the text for Graphviz names drones and connections by ids, and is the same while only numbers change")
{
    const auto first = dot_of(hive::graph(look(100, 0, 0, 1s).answers)),
               second = dot_of(hive::graph(look(900, 5, 7, 9s).answers));
    CHECK(first == second);
    for (const auto* part :
         {R"(id="drone:source")", R"(id="edge:source.image>worker.image>")", R"(subgraph "cluster local")"})
        CHECK_MESSAGE(first.find(part) != std::string::npos, first);
}

TEST_CASE("dash: many drones that are alike stand in several columns")
{
    const auto farthest = [](int workers) {
        auto source = source_of(10, 0);
        std::vector<hive::StatusAnswer> answers;
        auto edge = status_in(source).outputs[0].edges.at(0);
        status_in(source).outputs[0].edges.clear();
        for (int i = 0; i < workers; ++i) {
            auto worker = worker_of(10, 0);
            worker.drone = "worker-" + std::to_string(i);
            edge.receiver = worker.drone + ".image";
            status_in(source).outputs[0].edges.push_back(edge);
            answers.push_back(worker);
        }
        answers.push_back(source);
        const auto dot = dot_of(hive::graph(answers));
        int most = 0;
        for (int length = 1; length < 40; ++length)
            if (dot.find("minlen=" + std::to_string(length) + "]") != std::string::npos)
                most = length;
        return most;
    };
    CHECK(farthest(8) == 1);
    CHECK(farthest(63) == 6);
    CHECK(farthest(300) == 12);
}

TEST_CASE("dash: an image is shrunk by whole numbers, and not below the width of its box")
{
    CHECK(size_of(image_for_page(raw(640, 480, "bgr8", 3), 640)) == std::pair(640, 480));
    CHECK(size_of(image_for_page(raw(640, 480, "bgr8", 3), 320)) == std::pair(320, 240));
    CHECK(size_of(image_for_page(raw(1000, 10, "gray8", 1), 320)) == std::pair(333, 3));
    CHECK(size_of(image_for_page(raw(1920, 1080, "bgra8", 4), 640)) == std::pair(640, 360));
    CHECK(size_of(image_for_page(raw(1920, 1, "gray8", 1), 320)) == std::pair(320, 1));
    CHECK(size_of(image_for_page(raw(3, 3, "gray8", 1), 320)) == std::pair(3, 3));
    const auto jpeg = event_of(image_for_page(raw(1280, 720, "bgr8", 3), 1280));
    CHECK(size_of(image_for_page(jpeg, 320)) == std::pair(320, 180));
    CHECK(image_for_page(jpeg, 1280).bytes.size() == jpeg.body.size());
}

TEST_CASE("dash: an image that lies about its size, is broken, or is nothing for browsers is refused")
{
    auto lying = raw(640, 480, "bgr8", 3);
    lying.header["height"] = 481;
    CHECK_THROWS_AS(image_for_page(lying, 320), hive::Error);
    CHECK_THROWS_AS(image_for_page(raw(64, 48, "yuv", 3), 320), hive::Error);
    hive::Event broken;
    broken.type = "image/jpeg";
    broken.body = hive::Body(std::string("no JPEG"));
    CHECK_THROWS_AS(image_for_page(broken, 320), hive::Error);
    broken.type = "image/svg+xml";
    CHECK_THROWS_AS(image_for_page(broken, 320), hive::Error);
}
