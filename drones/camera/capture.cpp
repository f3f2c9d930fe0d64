// The capture thread. Everything it touches is in Shared, which it keeps alive itself.
#include "capture.hpp"

#include "pacing.hpp"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

namespace camera {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds stalled_after{2};
constexpr std::chrono::milliseconds end_within{500};
constexpr double usual_fps = 30;

}  // namespace

struct Capture::Shared {
    Opener open;  // of the thread alone, like fps and at_end
    double fps;
    AtEnd at_end;
    Backoff backoff;  // begins anew with each picture

    std::mutex mutex;  // for all below
    std::condition_variable changed;
    std::function<void()> notice;
    bool stopping = false, ended = false;
    std::optional<Frame> newest;
    std::string trouble;  // empty while the source is open
    Clock::time_point last_news = Clock::now();

    /// False if the capture is to end.
    bool wait_until(Clock::time_point when)
    {
        std::unique_lock lock(mutex);
        changed.wait_until(lock, when, [&] { return stopping; });
        return !stopping;
    }

    void say(const std::string& text)
    {
        const std::lock_guard lock(mutex);
        trouble = text;
        last_news = Clock::now();
        if (!stopping)
            notice();
    }

    void post(Frame frame)
    {
        backoff.reset();
        const std::lock_guard lock(mutex);
        newest = std::move(frame);
        trouble.clear();
        last_news = Clock::now();
        if (!stopping)
            notice();
    }

    enum class Outcome { stopped, ended };

    /// A file is held back until its picture is due. One that cannot be read is passed over.
    Outcome read_file(Source& source)
    {
        Schedule schedule(fps > 0 ? fps : source.fps() > 0 ? source.fps() : usual_fps, Clock::now());
        for (; wait_until(schedule.due()); schedule.take(Clock::now()))
            try {
                auto frame = source.next();
                if (!frame)
                    return Outcome::ended;
                post(std::move(*frame));
            } catch (const std::exception& problem) {
                say(problem.what());
            }
        return Outcome::stopped;
    }

    /// A camera cannot be held back: what comes too early for the schedule (by more than its jitter) is left out.
    Outcome read_camera(Source& source)
    {
        const std::chrono::duration<double> jitter(fps > 0 ? 0.25 / fps : 0);
        Schedule schedule(fps, Clock::now());
        while (wait_until(Clock::now())) {
            auto frame = source.next();
            if (!frame)
                return Outcome::ended;
            if (const auto now = Clock::now(); now + jitter >= schedule.due()) {
                schedule.take(now);
                post(std::move(*frame));
            }
        }
        return Outcome::stopped;
    }

    /// One life of the source; false if there shall be no other.
    bool open_and_read()
    {
        try {
            const auto source = open();
            const bool camera = at_end == AtEnd::open_again;
            if ((camera ? read_camera(*source) : read_file(*source)) == Outcome::stopped)
                return false;
            say(camera ? "connection to the source lost" : "end of source");
            return camera;
        } catch (const std::exception& problem) {
            say(problem.what());
            return true;
        }
    }

    void run()
    {
        while (open_and_read() && wait_until(Clock::now() + backoff.next())) {
        }
        const std::lock_guard lock(mutex);
        ended = true;
        changed.notify_all();
    }
};

Capture::Capture(Opener open, double fps, AtEnd at_end, std::function<void()> notice)
    : shared_(std::make_shared<Shared>())
{
    shared_->open = std::move(open);
    shared_->fps = fps;
    shared_->at_end = at_end;
    shared_->notice = std::move(notice);
    thread_ = std::thread([shared = shared_] { shared->run(); });
}

Capture::~Capture()
{
    std::unique_lock lock(shared_->mutex);
    shared_->stopping = true;
    shared_->changed.notify_all();
    const bool ended = shared_->changed.wait_for(lock, end_within, [&] { return shared_->ended; });
    lock.unlock();
    if (ended)
        thread_.join();
    else
        thread_.detach();
}

std::optional<Frame> Capture::take()
{
    const std::lock_guard lock(shared_->mutex);
    return std::exchange(shared_->newest, std::nullopt);
}

std::string Capture::condition(Clock::time_point now) const
{
    const std::lock_guard lock(shared_->mutex);
    if (!shared_->trouble.empty())
        return shared_->trouble;
    return now - shared_->last_news > stalled_after ? "stalled" : "";
}

}  // namespace camera
