// The capture thread and its pace: newest image, conditions, a source that hangs.
#include "capture.hpp"
#include "pacing.hpp"

#include <doctest/doctest.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

using camera::Capture;
using camera::Frame;
using camera::Source;
using namespace std::chrono_literals;

namespace {

constexpr auto deadline = 60s;  // reached only by a hang

/// Counts notices; a test waits for them instead of sleeping.
class Bell {
public:
    void ring()
    {
        const std::lock_guard lock(mutex_);
        ++rung_;
        changed_.notify_all();
    }
    bool wait_for(int times, std::chrono::seconds most = deadline)
    {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, most, [&] { return rung_ >= times; });
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int rung_ = 0;
};

/// What a source under the test's control shall do; next() hangs while there is nothing to do.
class Script {
public:
    enum class Act { give, give_timed, begin_again, end, fail };
    static constexpr std::chrono::milliseconds distance{400};  ///< of those with a time, as a video has them

    void play(Act act)
    {
        const std::lock_guard lock(mutex_);
        acts_.push_back(act);
        changed_.notify_all();
    }
    std::optional<Frame> next()
    {
        std::unique_lock lock(mutex_);
        reading_.ring();
        changed_.wait(lock, [&] { return !acts_.empty(); });
        const Act act = acts_.front();
        acts_.pop_front();
        if (act == Act::fail)
            throw std::runtime_error("broken");
        if (act == Act::end)
            return std::nullopt;
        Frame frame;
        frame.index = count_++;
        frame.restarts = act == Act::begin_again;
        if (act == Act::give_timed)
            frame.media_time = frame.index * distance;
        return frame;
    }
    Bell& reading() { return reading_; }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Act> acts_;
    std::int64_t count_ = 0;
    Bell reading_;
};

class ScriptedSource : public Source {
public:
    ScriptedSource(std::shared_ptr<Script> script, std::shared_ptr<Bell> gone)
        : script_(std::move(script)), gone_(std::move(gone))
    {
    }
    ~ScriptedSource() override { gone_->ring(); }
    std::optional<Frame> next() override { return script_->next(); }

private:
    std::shared_ptr<Script> script_;
    std::shared_ptr<Bell> gone_;
};

struct Stage {
    std::shared_ptr<Script> script = std::make_shared<Script>();
    std::shared_ptr<Bell> gone = std::make_shared<Bell>(), opened = std::make_shared<Bell>();
    Bell news;

    std::unique_ptr<Capture> capture(double fps, Capture::AtEnd at_end)
    {
        auto open = [script = script, gone = gone, opened = opened]() -> std::unique_ptr<Source> {
            opened->ring();
            return std::make_unique<ScriptedSource>(script, gone);
        };
        return std::make_unique<Capture>(open, fps, at_end, [this] { news.ring(); });
    }
};

}  // namespace

TEST_CASE("schedule: small delays do not add up, a long pause is not made up for")
{
    using camera::Schedule;
    const Schedule::Clock::time_point start{1000s};
    Schedule schedule(10, start);
    CHECK(schedule.due() == start);
    for (int i = 0; i < 50; ++i)
        schedule.take(schedule.due() + 30ms);
    CHECK(schedule.due() == start + 5s);
    schedule.take(schedule.due() + 150ms);  // late by more than one, but the next is still to come
    CHECK(schedule.due() == start + 5100ms);
    schedule.take(start + 60s);
    CHECK(schedule.due() == start + 60s + 100ms);
}

TEST_CASE("schedule: without a rate an image is always due")
{
    const camera::Schedule::Clock::time_point start{1000s};
    camera::Schedule schedule(0, start);
    schedule.take(start + 1h);
    CHECK(schedule.due() == start);
}

TEST_CASE("schedule: a video is shown at its own times, and a leap costs at most one image")
{
    const camera::OwnTimes::Clock::time_point start{1000s};
    camera::OwnTimes own(100ms);
    CHECK(own.due(5s, start) == start);
    CHECK(own.due(5'030ms, start) == start + 30ms);
    CHECK(own.due(6s, start + 30ms) == start + 1s);
    CHECK(own.next() == start + 1'100ms);
    CHECK(own.due(6'100ms, start + 1'190ms) == start + 1'100ms);  // late by less than an image
    CHECK(own.due(6'200ms, start + 4s) == start + 4s);            // missed frames are not made up for
    CHECK(own.due(0s, start + 4s) == start + 4'100ms);            // it restarts
    CHECK(own.due(2min, start + 4'100ms) == start + 4'200ms);
}

TEST_CASE("capture: the images of a video come at its times, also the last before the end")
{
    Stage stage;
    const auto before = std::chrono::steady_clock::now();
    const auto capture = stage.capture(0, Capture::AtEnd::stop);
    for (int i = 0; i < 3; ++i)
        stage.script->play(Script::Act::give_timed);
    stage.script->play(Script::Act::end);
    REQUIRE(stage.news.wait_for(3));
    CHECK(std::chrono::steady_clock::now() - before >= 2 * Script::distance);
    REQUIRE(stage.news.wait_for(4));
    CHECK(std::chrono::steady_clock::now() - before >= 2 * Script::distance + 33ms);
    CHECK(capture->ended());
}

TEST_CASE("capture: an image that is not yet due is not a stall")
{
    Stage stage;
    const auto capture = stage.capture(0.1, Capture::AtEnd::stop);
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(1));
    const auto begin = std::chrono::steady_clock::now();
    const auto waits = [&] { return capture->condition(begin + 6s).empty(); };  // of ten
    while (!waits() && std::chrono::steady_clock::now() < begin + 5s)
        std::this_thread::sleep_for(1ms);
    CHECK(waits());
    stage.script->play(Script::Act::end);
}

TEST_CASE("capture: only the newest image is kept, and only once")
{
    Stage stage;
    const auto capture = stage.capture(0, Capture::AtEnd::open_again);
    CHECK_FALSE(capture->take());
    for (int i = 0; i < 3; ++i)
        stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(3));
    CHECK(capture->take()->index == 2);
    CHECK_FALSE(capture->take());
    CHECK(capture->condition().empty());
    stage.script->play(Script::Act::end);
}

TEST_CASE("capture: a restart of a video is reported with the next image taken")
{
    Stage stage;
    const auto capture = stage.capture(0, Capture::AtEnd::open_again);
    int given = 0;
    for (const auto act : {Script::Act::give, Script::Act::begin_again, Script::Act::give}) {
        stage.script->play(act);
        REQUIRE(stage.news.wait_for(++given));
    }
    CHECK(capture->take()->restarts);
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(++given));
    CHECK_FALSE(capture->take()->restarts);
    stage.script->play(Script::Act::end);
}

TEST_CASE("capture: a source without news for more than 2 s has stalled")
{
    Stage stage;
    const auto capture = stage.capture(0, Capture::AtEnd::open_again);
    const auto before = std::chrono::steady_clock::now();
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(1));
    const auto after = std::chrono::steady_clock::now();  // the news came in between
    CHECK(capture->condition(before + 1900ms).empty());
    CHECK(capture->condition(after + 2100ms) == "stalled");
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(2));
    CHECK(capture->condition().empty());
    stage.script->play(Script::Act::end);
}

TEST_CASE("capture: the end of a file is reported, and its last image can still be taken")
{
    Stage stage;
    const auto capture = stage.capture(500, Capture::AtEnd::stop);
    stage.script->play(Script::Act::give);
    stage.script->play(Script::Act::end);
    REQUIRE(stage.news.wait_for(2));
    CHECK(capture->condition() == "end of source");
    CHECK(capture->condition(std::chrono::steady_clock::now() + 1h) == "end of source");
    CHECK(capture->take()->index == 0);
    CHECK(stage.gone->wait_for(1));
}

TEST_CASE("capture: an unreadable image file is reported and skipped")
{
    Stage stage;
    const auto capture = stage.capture(500, Capture::AtEnd::stop);
    stage.script->play(Script::Act::fail);
    REQUIRE(stage.news.wait_for(1));
    CHECK(capture->condition() == "broken");
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(2));
    CHECK(capture->condition().empty());
    stage.script->play(Script::Act::fail);  // between others, it does not change the condition
    REQUIRE(stage.news.wait_for(3));
    CHECK(capture->condition().empty());
    CHECK(capture->problems() == std::vector<std::string>{"broken", "broken"});
    stage.script->play(Script::Act::end);
    REQUIRE(stage.news.wait_for(4));
    CHECK(capture->ended());
}

TEST_CASE("capture: a lost camera is reported and reopened")
{
    Stage stage;
    const auto capture = stage.capture(0, Capture::AtEnd::open_again);
    stage.script->play(Script::Act::end);
    REQUIRE(stage.news.wait_for(1));
    CHECK(capture->condition() == "connection to the source lost");
    REQUIRE(stage.opened->wait_for(2));  // after the first pause of half a second
    stage.script->play(Script::Act::give);
    REQUIRE(stage.news.wait_for(2));
    CHECK(capture->condition().empty());
    stage.script->play(Script::Act::end);
}

TEST_CASE("capture: the reason why a source does not open is reported")
{
    Bell news;
    const Capture capture([]() -> std::unique_ptr<Source> { throw std::runtime_error("no such camera"); }, 0,
                          Capture::AtEnd::open_again, [&] { news.ring(); });
    REQUIRE(news.wait_for(1));
    CHECK(capture.condition() == "no such camera");
}

TEST_CASE("capture: one that hangs in a read does not keep its owner, and gives no more notice")
{
    Stage stage;
    auto capture = stage.capture(0, Capture::AtEnd::open_again);
    REQUIRE(stage.script->reading().wait_for(1));
    capture.reset();                           // which waited for the read for ever would not come back
    CHECK_FALSE(stage.gone->wait_for(1, 0s));  // the read hangs still
    stage.script->play(Script::Act::give);     // the hanging read comes back after all
    CHECK(stage.gone->wait_for(1));            // its thread ends and takes the source with it
    CHECK_FALSE(stage.news.wait_for(1, 0s));
}
