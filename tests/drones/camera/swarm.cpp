// The camera drone in a swarm: unreadable images are reported, and block no receiver.
#include "media.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <opencv2/core/mat.hpp>

#include <algorithm>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

/// Six images, of which the third and the fourth are damaged: one cannot be read, one only not be decoded.
void fill(const std::filesystem::path& folder)
{
    const auto png = media::encoded(".png", media::sample({64, 48}, CV_8UC3));
    auto jpeg = media::encoded(".jpg", media::sample({64, 48}, CV_8UC3));
    for (const char* name : {"1.png", "2.png", "5.png", "6.png"})
        media::write(folder / name, png);
    media::write(folder / "3.png", media::Bytes(png.begin(), png.begin() + 30));
    jpeg.resize(jpeg.size() / 2);
    jpeg.insert(jpeg.end(), {0xFF, 0xD9});
    media::write(folder / "4.jpg", jpeg);
}

}  // namespace

TEST_CASE("camera: a damaged image in a folder on demand has a number and an exception, and blocks no receiver")
{
    const Swarm swarm;
    const media::Folder folder;
    fill(folder.path());
    const auto camera =
        swarm.drone("camera", "camera", {"source=" + folder.path().string(), "width=32", "pace=demand", "loop=off"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"camera"});
    const auto images = application.collect({{"camera", "image"}}, {.ordered = true});
    for (const std::int64_t sequence : {1, 2, 5, 6}) {
        const auto event = images->next(patient(5000ms));
        REQUIRE(event);
        CHECK(event->identity.sequence == sequence);
        CHECK(event->header.at("index") == sequence - 1);
    }
    CHECK(images->counts().failed == 2);
    CHECK(images->counts().missing == 0);
    for (const auto& [sequence, file] : {std::pair{3, "3.png"}, std::pair{4, "4.jpg"}}) {
        const auto exception = exceptions->next(patient(2000ms));
        REQUIRE(exception);
        CHECK(exception->identity.source == "camera");
        CHECK(exception->identity.sequence == sequence);
        CHECK(exception->header.at("text").get<std::string>().find((folder.path() / file).string()) == 0);
    }
}

TEST_CASE("camera: a broken image in a loop is an exception with its name, once")
{
    const Swarm swarm;
    const media::Folder folder;
    fill(folder.path());
    for (const char* pace : {"live", "demand"}) {
        CAPTURE(std::string(pace));
        const auto camera =
            swarm.drone("camera", "camera-" + std::string(pace),
                        {"source=" + folder.path().string(), "width=32", "fps=200", "pace=" + std::string(pace)});
        auto application = swarm.application();
        const auto name = "camera-" + std::string(pace);
        const auto images = application.collect({{name, "image"}});
        for (int i = 0; i < 30; ++i)
            REQUIRE(images->next(patient(5000ms)));
        const auto& outputs = application.status(name).outputs;
        const auto found = std::ranges::find(outputs, std::string("exceptions"), &hive::OutputStatus::name);
        REQUIRE(found != outputs.end());
        CHECK(found->produced == 2);
    }
}

TEST_CASE("camera: the events of a file say where they are from, and another source is another epoch")
{
    const Swarm swarm;
    const media::Folder folder;
    const auto png = media::encoded(".png", media::sample({64, 48}, CV_8UC3));
    for (const char* name : {"1.png", "2.png"})
        media::write(folder.path() / name, png);
    const auto source = folder.path().string();
    const auto camera = swarm.drone("camera", "camera", {"source=" + source, "pace=demand", "loop=off", "fps=10"});
    auto application = swarm.application();
    const auto images = application.collect({{"camera", "image"}});
    const auto first = images->next(patient(5000ms)), second = images->next(patient(5000ms));
    REQUIRE((first && second));
    CHECK(first->header.at("file") == source + "/1.png");
    CHECK(second->header.at("media_time_us") == 100'000);
    CHECK_FALSE(images->next(patient(5000ms)));
    CHECK(images->ended() == "");
    CHECK(application.status("camera").why == hive::Reason::source_ended);
    application.set("camera", {{"source", source + "/2.png"}});
    std::optional<hive::Event> other;
    REQUIRE(eventually([&] { return (other = images->next(50ms)).has_value(); }));
    CHECK(other->identity.epoch > second->identity.epoch);
    CHECK(other->identity.sequence == 1);
}

TEST_CASE("camera: an image that exceeds the limit is reported, and has its number in the sequence")
{
    const Swarm swarm;
    const media::Folder folder;
    const auto usual = media::encoded(".png", media::sample({64, 48}, CV_8UC3));
    media::write(folder.path() / "1.png", usual);
    media::write(folder.path() / "2.png", media::encoded(".png", media::sample({10, 4000}, CV_8UC3)));
    media::write(folder.path() / "3.png", usual);
    const auto camera =
        swarm.drone("camera", "camera", {"source=" + folder.path().string(), "width=400", "pace=demand", "loop=off"});
    auto application = swarm.application();
    const auto exceptions = application.exceptions({"camera"});
    const auto images = application.collect({{"camera", "image"}}, {.ordered = true});
    for (const std::int64_t sequence : {1, 3}) {
        const auto event = images->next(patient(5000ms));
        REQUIRE(event);
        CHECK(event->identity.sequence == sequence);
    }
    const auto exception = exceptions->next(patient(2000ms));
    REQUIRE(exception);
    CHECK(exception->identity.sequence == 2);
    CHECK(has(exception->header.at("text"), "400x160000 px are more than 40 Mpixel"));
}
