// The HTTP server of the view drone while images take long to decode.
#include "stage.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <future>
#include <utility>

using hive::test::eventually, hive::test::Milliseconds;
using http::Client, http::get;
using stage::next_width, stage::Stage;

namespace {

/// Longer than any answer takes that does not wait for an image.
constexpr Milliseconds hang(60'000);

/// Images whose decoding lasts until they are released.
class Stuck {
public:
    explicit Stuck(Stage& stage) : stage_(stage) {}
    ~Stuck() { let_go(); }
    Stuck(const Stuck&) = delete;
    Stuck& operator=(const Stuck&) = delete;

    void put(int width)
    {
        stage_.put_pixels([width, begun = begun_, gone = gone_] {
            ++*begun;
            gone.wait_for(hang);
            return cv::Mat(30, width, CV_8UC3, cv::Scalar::all(1));
        });
    }
    void let_go()
    {
        if (!std::exchange(let_go_, true))
            go_.set_value();
    }
    /// How many are being decoded, or were.
    [[nodiscard]] int begun() const { return *begun_; }

private:
    Stage& stage_;
    std::shared_ptr<std::atomic<int>> begun_ = std::make_shared<std::atomic<int>>(0);
    std::promise<void> go_;
    std::shared_future<void> gone_ = go_.get_future().share();
    bool let_go_ = false;
};

}  // namespace

TEST_CASE("view server: while an image of 40 Mpixel is decoded for one browser the others are answered at once")
{
    const cv::Size size(8000, 5000);
    std::vector<unsigned char> png;
    {
        cv::Mat tile(500, 500, CV_8UC3);
        cv::randu(tile, 0, 255);
        cv::imencode(".png", cv::repeat(tile, size.height / tile.rows, size.width / tile.cols), png,
                     {cv::IMWRITE_PNG_COMPRESSION, 1});
    }
    std::atomic<bool> begun{false};
    std::promise<void> all_answered;
    Stage stage({.preparing = 2 * hang});
    Client looking(stage.port());
    stage.put_pixels([&, answered = all_answered.get_future().share()] {
        begun = true;
        auto image = cv::imdecode(png, cv::IMREAD_COLOR);
        answered.wait_for(hang);  // an answer that waited for this image would not come before its reader gives up
        return image;
    });
    looking.ask("/picture.jpg");
    REQUIRE(eventually([&] { return begun.load(); }, Milliseconds(5000)));
    for (int i = 0; i < 5; ++i)
        for (const char* path : {"/status.json", "/"})
            CHECK(get(stage.port(), path).code == 200);
    CHECK_FALSE(looking.more_within(Milliseconds(1)));
    all_answered.set_value();
    CHECK(looking.reply(hang).image().size() == size);
}

TEST_CASE("view server: of the images that arrive during decoding only the newest is decoded")
{
    Stage stage;
    Client streaming(stage.port()), looking(stage.port());
    Stuck stuck(stage);
    stuck.put(40);
    streaming.ask("/stream.mjpg");
    REQUIRE(eventually([&] { return stuck.begun() == 1; }, Milliseconds(5000)));
    for (int width = 41; width <= 60; ++width) {
        stuck.put(width);
        REQUIRE(get(stage.port(), "/status.json").code == 200);  // so that the server has seen this one
    }
    looking.ask("/picture.jpg");
    stuck.let_go();
    CHECK(looking.reply().image().cols == 60);
    const int first = next_width(streaming);  // 40, unless both were ready before it had its turn
    CHECK((first == 40 ? next_width(streaming) : first) == 60);
    CHECK(stuck.begun() == 2);
}

TEST_CASE("view server: a request that waits too long gets an error, and a later one the image")
{
    Stage stage({.preparing = Milliseconds(300)});
    Stuck stuck(stage);
    stuck.put(40);
    Client one(stage.port()), two(stage.port());
    one.ask("/picture.jpg");
    two.ask("/plain/stream.mjpg");
    for (auto* client : {&one, &two}) {
        const auto reply = client->reply();
        CHECK(reply.code == 503);
        CHECK(reply.body == "The image is not ready yet; ask again.\n");
    }
    CHECK(stage.browsers() == 0);
    stuck.let_go();
    CHECK(eventually([&] {
        const auto reply = get(stage.port(), "/picture.jpg");
        return reply.code == 200 && reply.image().cols == 40;
    }));
}

TEST_CASE("view server: a viewer that disconnects while waiting frees its place")
{
    Stage stage({.connections = 1});
    Stuck stuck(stage);
    stuck.put(40);
    {
        Client leaving(stage.port());
        leaving.ask("/picture.jpg");
        REQUIRE(eventually([&] { return stuck.begun() == 1; }, Milliseconds(5000)));
        CHECK(get(stage.port(), "/").code == 503);
    }
    stuck.let_go();
    CHECK(eventually([&] { return get(stage.port(), "/picture.jpg").code == 200; }, Milliseconds(5000)));
}

TEST_CASE("view server: stops while an image is being decoded, and releases the waiting viewers")
{
    auto stage = std::make_unique<Stage>();
    Stuck stuck(*stage);
    stuck.put(40);
    Client looking(stage->port()), streaming(stage->port());
    looking.ask("/picture.jpg");
    streaming.ask("/stream.mjpg");
    REQUIRE(eventually([&] { return stuck.begun() == 1; }, Milliseconds(5000)));
    const auto ended = std::async(std::launch::async, [&] { stage.reset(); });
    for (auto* client : {&looking, &streaming})
        CHECK(client->closed_within(hang / 2));  // before the image is ready
    stuck.let_go();
    CHECK(ended.wait_for(hang) == std::future_status::ready);
}
