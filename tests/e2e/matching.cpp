// Matching events of several inputs: the annotate drone, applications and hivectl collect.
#include "measure.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <set>
#include <sstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr int images = sanitized() ? 8 : 30;

hive::MatchingStatus matching(hive::Application& application) { return application.status("annotate").matching.at(0); }

/// Is the box framed in green, at the middle of its left side?
bool framed(const hive::Event& image, const Json& box)
{
    const auto x = box.at("x").get<std::size_t>(),
               y = box.at("y").get<std::size_t>() + box.at("h").get<std::size_t>() / 2;
    const auto* pixel = image.body.data() + y * image.header.at("stride").get<std::size_t>() + 3 * x;
    return pixel[0] == 60 && pixel[1] == 220 && pixel[2] == 60;
}

/// A camera on demand that waits until all is connected, a face drone, and a match of both.
class AnnotateSwarm {
public:
    explicit AnnotateSwarm(int workers = 1, const std::vector<std::string>& camera = {"pace=demand", "width=320"})
        : camera_(swarm.drone("camera", "camera", camera)), annotate_(swarm.drone("annotate", "annotate"))
    {
        for (int i = 1; i <= workers; ++i)
            faces.push_back(swarm.drone("face", "face-" + std::to_string(i)));
        annotated = application.collect({{"annotate", "annotated"}});
        application.halt("camera");
        for (int i = 1; i <= workers; ++i)
            application.connect({"face-" + std::to_string(i), "faces"}, {"annotate", "marks"});
        application.connect({"camera", "image"}, {"annotate", "image"}, {.window = 64, .group = {}, .lease = {}});
        for (int i = 1; i <= workers; ++i)
            application.connect({"camera", "image"}, {"face-" + std::to_string(i), "image"},
                                {.group = workers > 1 ? "faces" : "", .lease = {}});
    }

    Swarm swarm;
    hive::Application application{swarm.application()};
    std::vector<Process> faces;
    std::unique_ptr<hive::Collector> annotated;

private:
    Process camera_, annotate_;
};

}  // namespace

TEST_CASE("annotate: on demand every image is drawn with exactly its boxes, none is missing, none comes twice")
{
    AnnotateSwarm swarm;
    const auto boxes = swarm.application.collect({{"face-1", "faces"}});
    swarm.application.resume("camera");
    for (std::int64_t expected = 1; expected <= images; ++expected) {
        const auto image = swarm.annotated->next(patient(5000ms)), found = boxes->next(patient(5000ms));
        REQUIRE(image);
        REQUIRE(found);
        REQUIRE(image->identity.source == "camera");
        REQUIRE(image->identity.sequence == expected);
        REQUIRE(found->identity.sequence == expected);
        CHECK(image->identity.lossless);
        CHECK(image->header.at("marks") == found->header);
        CHECK(image->header.at("apart_ms") == 0);
        for (const auto& box : found->header.at("faces"))
            CHECK(framed(*image, box));
    }
    const auto counts = matching(swarm.application);
    CHECK(counts.unmatched == 0);
    CHECK(counts.duplicates == 0);
    CHECK(counts.missing == std::map<std::string, std::int64_t>{{"image", 0}, {"marks", 0}});
}

TEST_CASE("annotate: both inputs of its match have the time of the callback for both")
{
    AnnotateSwarm swarm;
    swarm.application.resume("camera");
    REQUIRE(swarm.annotated->next(patient(5000ms)).has_value());
    REQUIRE(swarm.annotated->next(patient(5000ms)).has_value());  // the callback for the first one has ended
    const auto inputs = swarm.application.status("annotate").inputs;
    REQUIRE(inputs.size() == 2);
    for (const auto& input : inputs)
        CHECK_MESSAGE(input.work_p99_us > 0, input.input);
}

TEST_CASE("annotate: on demand with two workers that share, one of them killed, every image comes exactly once")
{
    AnnotateSwarm swarm(2);
    swarm.application.resume("camera");
    std::set<std::int64_t> seen;
    for (int i = 0; i < images; ++i) {
        if (i == images / 3)
            swarm.faces[0].kill();
        const auto image = swarm.annotated->next(patient(10'000ms));
        REQUIRE(image);
        REQUIRE(seen.insert(image->identity.sequence).second);
    }
    // Missing ones before the last are still in flight, and arrive.
    while (*seen.rbegin() > static_cast<std::int64_t>(seen.size()) + 2) {
        const auto image = swarm.annotated->next(patient(10'000ms));
        REQUIRE(image);
        REQUIRE(seen.insert(image->identity.sequence).second);
    }
    CHECK(matching(swarm.application).missing == std::map<std::string, std::int64_t>{{"image", 0}, {"marks", 0}});
}

TEST_CASE("annotate: live, with a detector slower than the camera, all boxes find their images, and the other "
          "images are counted as without marks")
{
    AnnotateSwarm swarm(1, {"fps=60", "width=320"});
    swarm.application.set("face-1", {{"scale", 1.05}});
    swarm.application.resume("camera");
    std::int64_t last = 0;
    for (int i = 0; i < 8; ++i) {
        const auto image = swarm.annotated->next(patient(5000ms));
        REQUIRE(image);
        CHECK(image->identity.sequence > last);
        last = image->identity.sequence;
        for (const auto& box : image->header.at("marks").at("faces"))
            CHECK(framed(*image, box));
    }
    CHECK(
        eventually([&] { return matching(swarm.application).sets >= 8; }));  // the last is counted after it was emitted
    const auto counts = matching(swarm.application);
    CHECK(counts.missing.at("image") == 0);
    CHECK(counts.missing.at("marks") > 0);
    CHECK(swarm.swarm.hivectl_done({"ps", "annotate", "--timeout", "10"}).find(" without marks") != std::string::npos);
    const auto row = Json::parse(swarm.swarm.hivectl_done({"ps", "annotate", "--json", "--timeout", "10"})).at(0);
    CHECK(row.at("matching").at(0).at("inputs") == Json{"image", "marks"});
}

TEST_CASE("annotate: it remembers images, so it is refused as a member of a group")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera"), annotate = swarm.drone("annotate", "annotate");
    const auto refused = swarm.hivectl({"connect", "camera.image", "annotate.image", "--share"});
    CHECK(refused.exit_code == 5);
    CHECK(refused.err.find("cannot share") != std::string::npos);
}

TEST_CASE("matched: an application gets sets of a source and a worker that leaves one out, none of the others missing, "
          "and nothing stands still")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=60"});
    const auto worker = swarm.drone("sleeper", "worker", {"throw_at=20"});
    auto application = swarm.application();
    application.halt("source");
    hive::CollectOptions one_at_a_time;
    one_at_a_time.connection.window = 1;
    const auto collector =
        application.collect_matched({{"source", ""}, {"worker", ""}}, hive::Match::exact(), one_at_a_time);
    application.connect({"source", ""}, {"worker", ""});
    application.resume("source");
    for (std::int64_t expected = 1; expected <= 60; ++expected) {
        if (expected == 20)
            continue;
        const auto set = collector->next(stated(3500ms));  // shorter than a matcher's timeout
        REQUIRE_MESSAGE(set, "no set ", expected);
        REQUIRE(set->size() == 2);
        CHECK(set->at(0).input == "source.tick");
        REQUIRE(set->at(0).identity.sequence == expected);
        REQUIRE(set->at(1).identity.sequence == expected);
        CHECK(set->at(1).header.at("seq") == expected);
    }
    const auto counts = collector->counts();
    CHECK(counts.sets == 59);
    CHECK(counts.unmatched == 1);
    CHECK(counts.missing.at("worker.result") == 1);
}

TEST_CASE("matched: live sources are brought together by the time of their captures")
{
    const Swarm swarm;
    const auto fast = swarm.drone("ticker", "fast", {"fps=100"}), slow = swarm.drone("ticker", "slow", {"fps=20"});
    auto application = swarm.application();
    const auto collector = application.collect_matched({{"slow", ""}, {"fast", ""}}, hive::Match::within(stated(40ms)));
    std::int64_t last = 0;
    for (int i = 0; i < 20; ++i) {
        const auto set = collector->next(patient(5000ms));
        REQUIRE(set);
        CHECK(set->at(0).identity.source == "slow");
        CHECK(set->at(1).identity.source == "fast");
        CHECK(set->at(0).identity.sequence > last);
        last = set->at(0).identity.sequence;
        CHECK(std::abs(set->at(0).identity.captured_us - set->at(1).identity.captured_us) <= stated(40ms) / 1us);
    }
    CHECK(collector->counts().missing.at("slow.tick") > 20);
}

TEST_CASE("matched: one output, or the same twice, makes no set")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source");
    auto application = swarm.application();
    CHECK_THROWS_WITH(application.collect_matched({{"source", "tick"}}), doctest::Contains("two outputs"));
    CHECK_THROWS_WITH(application.collect_matched({{"source", "tick"}, {"source", ""}}),
                      doctest::Contains("named twice"));
    CHECK(swarm.hivectl({"collect", "source"}).exit_code == 2);
    CHECK(swarm.hivectl({"collect", "source", "nobody"}).exit_code == 3);
}

TEST_CASE("hivectl collect: prints one JSON object for each set, and says on stderr what found no partner")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=100"});
    const auto worker = swarm.drone("sleeper", "worker", {"work_ms=50"});
    swarm.hivectl_done({"connect", "source", "worker"});
    const auto collected = swarm.hivectl({"collect", "source", "worker", "-n", "5", "--timeout", "10"});
    REQUIRE(collected.exit_code == 0);
    std::istringstream lines(collected.out);
    int count = 0;
    for (std::string line; std::getline(lines, line); ++count) {
        const auto set = Json::parse(line);
        CHECK(set.at("source") == "source");
        CHECK(set.at("spread_ms") == 0);
        REQUIRE(set.at("events").size() == 2);
        CHECK(set.at("events").at(0).at("sender") == "source");
        CHECK(set.at("events").at(0).at("size") == 1000);
        CHECK(set.at("events").at(1).at("header").at("seq") == set.at("seq"));
    }
    CHECK(count == 5);
    CHECK(collected.err.find("5 sets, ") != std::string::npos);
    CHECK(collected.err.find(" without worker.result") != std::string::npos);
    const auto within =
        swarm.hivectl({"collect", "source", "worker", "--within", "20", "-n", "2", "--notify", "--timeout", "10"});
    CHECK(within.exit_code == 0);
    CHECK(swarm.hivectl_done({"complete", "--", "collect", "wor"}) == "worker\n");
}
