// Opens the source, reads it at its pace, and reopens it when it is lost.
#include "capture.hpp"

#include "pacing.hpp"

#include <hive/backoff.hpp>

#include <algorithm>
#include <exception>
#include <mutex>
#include <utility>

namespace camera {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds stalled_after{2};
constexpr std::chrono::milliseconds shortest_pause{500}, longest_pause{10'000};
constexpr double default_fps = 30;
constexpr int max_refused_logins = 3;      ///< cameras lock out users after too many attempts
constexpr std::size_t max_problems = 100;  ///< pending

}  // namespace

class Capture::Work : public capture::FrameWork<Frame> {
public:
    Work(Opener open, double fps, AtEnd at_end, std::function<void()> notice, std::string opening)
        : FrameWork(std::move(notice)), open_(std::move(open)), fps_(fps), at_end_(at_end), opening_(std::move(opening))
    {
        last_error_ = opening_;  // before the thread begins, so that the first status has it
    }

    std::vector<std::string> problems()
    {
        const std::lock_guard lock(mutex_);
        return std::exchange(problems_, {});
    }

    [[nodiscard]] std::string cut_short() const
    {
        const std::lock_guard lock(mutex_);
        return cut_short_;
    }

    [[nodiscard]] bool gave_up() const
    {
        const std::lock_guard lock(mutex_);
        return gave_up_;
    }

    [[nodiscard]] bool ended() const
    {
        const std::lock_guard lock(mutex_);
        return file_ended_;
    }

    [[nodiscard]] std::string condition(Clock::time_point now) const
    {
        const std::lock_guard lock(mutex_);
        if (!last_error_.empty())
            return last_error_;
        return now - last_news_ > stalled_after ? "stalled" : "";
    }

private:
    enum class Outcome { stopped, ended };

    void say(const std::string& text)
    {
        const std::lock_guard lock(mutex_);
        last_error_ = text;
        last_news_ = Clock::now();
        notify();
    }

    void end(std::string cut_short)
    {
        const std::lock_guard lock(mutex_);
        cut_short_ = std::move(cut_short);
        file_ended_ = true;
        last_error_ = "end of source";
        notify();
    }

    void give_up(const std::string& text, bool for_good)
    {
        const std::lock_guard lock(mutex_);
        last_error_ = text;
        gave_up_ = for_good;
        notify();
    }

    void report(const std::string& problem)
    {
        const std::lock_guard lock(mutex_);
        if (problems_.size() < max_problems)
            problems_.push_back(problem);
        notify();
    }

    /// Skips an unreadable image. As long as others arrive, the condition of the source is unaffected.
    void pass_over(const std::string& problem)
    {
        const bool alone = !std::exchange(gives_images_, false);
        const std::lock_guard lock(mutex_);
        if (problems_.size() < max_problems)
            problems_.push_back(problem);
        if (alone) {
            last_error_ = problem;
            last_news_ = Clock::now();
        }
        notify();
    }

    void post(Frame frame)
    {
        backoff_.reset();
        logins_refused_ = 0;
        gives_images_ = true;
        const std::lock_guard lock(mutex_);
        frame.restarts |= newest_ && newest_->restarts;  // that one was not taken
        newest_ = std::move(frame);
        last_error_.clear();
        last_news_ = Clock::now();
        notify();
    }

    /// An image that is not yet due is not a stall.
    bool hold_until(Clock::time_point due)
    {
        {
            const std::lock_guard lock(mutex_);
            last_news_ = std::max(last_news_, due);
        }
        return wait_until(due);
    }

    /// Delays a file's image until it is due: at `fps`, or else by its own times. Skips an unreadable one.
    Outcome read_file(Source& source)
    {
        const double rate = fps_ > 0 ? fps_ : source.fps() > 0 ? source.fps() : default_fps;
        Schedule schedule(rate, Clock::now());
        OwnTimes own(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate)));
        while (hold_until(schedule.due()))
            try {
                auto frame = source.next();
                for (const auto& sentence : source.news())
                    report(sentence);
                if (!frame)
                    return hold_until(own.next()) ? Outcome::ended : Outcome::stopped;
                if (fps_ > 0 || !frame->media_time)
                    schedule.take(Clock::now());
                else if (!hold_until(own.due(*frame->media_time, Clock::now())))
                    return Outcome::stopped;
                frame->captured = std::chrono::system_clock::now();
                post(std::move(*frame));
            } catch (const std::exception& problem) {
                schedule.take(Clock::now());
                pass_over(problem.what());
            }
        return Outcome::stopped;
    }

    /// A camera cannot be delayed: frames that arrive too early for the schedule (by more than its jitter) are dropped.
    Outcome read_camera(Source& source)
    {
        const std::chrono::duration<double> jitter(fps_ > 0 ? 0.25 / fps_ : 0);
        Schedule schedule(fps_, Clock::now());
        while (wait_until(Clock::now())) {
            auto frame = source.next();
            for (const auto& sentence : source.news())
                report(sentence);
            if (!frame)
                return Outcome::ended;
            if (const auto now = Clock::now(); now + jitter >= schedule.due()) {
                schedule.take(now);
                post(std::move(*frame));
            }
        }
        return Outcome::stopped;
    }

    /// Opens the source and reads it until its end; false if it is not to be reopened.
    bool open_and_read()
    {
        try {
            if (!opening_.empty())
                say(std::exchange(opening_, ""));  // once: later the reason for reopening is known
            const auto source = open_();
            const bool camera = at_end_ == AtEnd::open_again;
            if ((camera ? read_camera(*source) : read_file(*source)) == Outcome::stopped)
                return false;
            if (camera)
                say("connection to the source lost");
            else
                end(source->cut_short());
            return camera;
        } catch (const LoginRefused& problem) {
            const bool again = ++logins_refused_ < max_refused_logins;
            give_up(problem.what() + std::string(again ? "" : "; set any parameter to retry"), !again);
            return again;
        } catch (const std::exception& problem) {
            say(problem.what());
            return true;
        }
    }

    void run() override
    {
        while (open_and_read() && wait_until(Clock::now() + backoff_.next())) {
        }
    }

    // of the thread alone
    Opener open_;
    double fps_;
    AtEnd at_end_;
    std::string opening_;
    hive::Backoff backoff_{shortest_pause, longest_pause};  ///< reset with each image
    int logins_refused_ = 0;
    bool gives_images_ = false;  ///< the last attempt at one did

    // under the mutex
    std::string last_error_;  ///< empty while the source is open
    bool file_ended_ = false, gave_up_ = false;
    std::string cut_short_;
    std::vector<std::string> problems_;
    Clock::time_point last_news_ = Clock::now();
};

Capture::Capture(Opener open, double fps, AtEnd at_end, std::function<void()> notice, std::string opening)
    : work_(std::make_shared<Work>(std::move(open), fps, at_end, std::move(notice), std::move(opening))), thread_(work_)
{
}

std::optional<Frame> Capture::take() { return work_->take(); }

std::vector<std::string> Capture::problems() { return work_->problems(); }

std::string Capture::cut_short() const { return work_->cut_short(); }

bool Capture::gave_up() const { return work_->gave_up(); }

bool Capture::ended() const { return work_->ended(); }

std::string Capture::condition(Clock::time_point now) const { return work_->condition(now); }

}  // namespace camera
