// The link's thread, and the calls of its owner.
#include "camera_link.hpp"

#include <mutex>
#include <utility>

namespace axis {
namespace {

using namespace std::chrono_literals;
using Clock = RetryPolicy::Clock;
constexpr std::chrono::milliseconds credentials_interval{1000}, frame_timeout{10'000};

/// Ends a session that restarts at once.
struct Restart {};

}  // namespace

class CameraLink::Work : public capture::FrameWork<Frame> {
public:
    Work(LinkSettings settings, LinkHooks hooks)
        : FrameWork(std::move(hooks.notice)),
          settings_(std::move(settings)),
          log_(std::move(hooks.log)),
          measure_(std::move(hooks.measure))
    {
    }

    void ask();
    void wanted(const Parameters& wanted);
    void restart();
    void once_more();
    [[nodiscard]] bool login_refused() const;
    [[nodiscard]] std::string condition() const;

private:
    void run() override;
    void session();
    void set_up(Camera& camera);
    void greet(const Model& model);
    void live(Camera& camera);
    void on_demand(Camera& camera);
    void accept(std::string bytes);
    void check();
    void pause();
    void look_for_credentials();
    void notice_news();
    [[nodiscard]] std::string current_condition() const;

    // of the thread alone
    LinkSettings settings_;                        ///< except `wanted`, which is under the mutex
    std::function<void(const std::string&)> log_;  ///< called under the mutex, so that it ends with the link
    std::function<Size(const std::string&)> measure_;
    std::filesystem::file_time_type credentials_written_ = written_at(settings_.credentials_path);
    std::int64_t count_ = 0;
    Clock::time_point last_frame_{};

    // under the mutex
    bool asked_ = false, restart_ = false;
    RetryPolicy retry_{Clock::now()};
    std::string settings_error_, last_condition_, greeting_;
};

/// The mutex is held.
std::string CameraLink::Work::current_condition() const
{
    const std::string condition = retry_.condition(Clock::now());
    return condition.empty() ? settings_error_ : condition;
}

void CameraLink::Work::notice_news()
{
    const std::lock_guard lock(mutex_);
    const std::string text = current_condition();
    if (std::exchange(last_condition_, text) != text)
        notify();
}

void CameraLink::Work::run()
{
    while (!is_stopping()) {
        try {
            session();
        } catch (const Restart&) {
        } catch (const CameraError& error) {
            const std::lock_guard again(mutex_);
            retry_.failed(error, Clock::now());
        } catch (const std::exception& error) {
            const std::lock_guard again(mutex_);
            retry_.failed(CameraError(Failure::refused_status, error.what()), Clock::now());
        }
        notice_news();
        pause();
    }
}

void CameraLink::Work::session()
{
    last_frame_ = Clock::now();
    Camera camera(settings_.access, [this] { check(); });
    set_up(camera);
    settings_.pace == Pace::live ? live(camera) : on_demand(camera);
}

/// An anonymous viewer may have access to images but not to parameters: then an image decides.
void CameraLink::Work::set_up(Camera& camera)
{
    Parameters wanted;
    {
        const std::lock_guard lock(mutex_);
        retry_.expect(Clock::now());
        restart_ = false;
        wanted = settings_.wanted;
    }
    std::string error_text;
    try {
        greet(camera.identify());
        camera.apply(wanted);
    } catch (const CameraError& error) {
        const bool anonymous = error.kind() == Failure::login_needed && !settings_.access.credentials;
        if (!anonymous && error.kind() != Failure::setting_refused)
            throw;
        if (!wanted.empty())
            error_text = error.what();
    }
    const std::lock_guard lock(mutex_);
    settings_error_ = error_text;
}

/// A camera that reconnects is logged once.
void CameraLink::Work::greet(const Model& model)
{
    const std::string text =
        masked("connected to " + model.name + ", firmware " + model.firmware + ", serial number " + model.serial);
    const std::lock_guard lock(mutex_);
    if (!stopping_ && std::exchange(greeting_, text) != text)
        log_(text);
}

void CameraLink::Work::live(Camera& camera)
{
    camera.stream([this](Part part) { accept(std::move(part.bytes)); });
}

void CameraLink::Work::on_demand(Camera& camera)
{
    while (true) {
        {
            std::unique_lock lock(mutex_);
            if (!asked_)
                retry_.expect_nothing();
            changed_.wait(lock, [&] { return asked_ || stopping_; });
            retry_.expect(Clock::now());
        }
        check();
        accept(camera.snapshot());
    }
}

/// Never passes on a truncated image.
void CameraLink::Work::accept(std::string bytes)
{
    Frame frame{.jpeg = {}, .size = {}, .index = count_, .captured = std::chrono::system_clock::now()};
    try {
        frame.size = measure_(bytes);
    } catch (const std::exception& problem) {
        const std::lock_guard lock(mutex_);
        retry_.broken(std::string("no complete image: ") + problem.what());
        if (settings_.pace == Pace::demand)
            throw CameraError(Failure::not_an_image, std::string("no complete image: ") + problem.what());
        return;
    }
    frame.jpeg = std::make_shared<const std::string>(std::move(bytes));
    ++count_;
    last_frame_ = Clock::now();
    const std::lock_guard lock(mutex_);
    retry_.frame(last_frame_);
    asked_ = false;
    newest_ = std::move(frame);
    last_condition_ = current_condition();
    notify();
}

/// Ten times a second while waiting for the network.
void CameraLink::Work::check()
{
    notice_news();
    if (Clock::now() - last_frame_ > frame_timeout && settings_.pace == Pace::live)
        throw CameraError(Failure::silent, "data, but no image");
    const std::lock_guard lock(mutex_);
    if (stopping_)
        throw CameraError(Failure::cancelled, "cancelled");
    if (std::exchange(restart_, false))
        throw Restart();
}

/// Until the next attempt is due.
void CameraLink::Work::pause()
{
    std::unique_lock lock(mutex_);
    while (!stopping_ && retry_.locked_out()) {
        changed_.wait_for(lock, credentials_interval, [&] { return stopping_ || !retry_.locked_out(); });
        lock.unlock();
        look_for_credentials();
        lock.lock();
    }
    changed_.wait_until(lock, retry_.next_try(), [&] { return stopping_; });
}

void CameraLink::Work::look_for_credentials()
{
    try {
        auto now = read_credentials(settings_.credentials_path);
        const auto written = written_at(settings_.credentials_path);
        const bool foreign = now && !now->camera.empty() && now->camera != settings_.access.url.text();
        if (foreign || (now == settings_.access.credentials && written == credentials_written_))
            return;
        settings_.access.credentials = std::move(now);
        credentials_written_ = written;
        const std::lock_guard lock(mutex_);
        retry_.new_credentials(Clock::now());
    } catch (const std::exception&) {  // being written or missing: the condition stays
    }
}

void CameraLink::Work::ask()
{
    const std::lock_guard lock(mutex_);
    asked_ = asked_ || !newest_;
    changed_.notify_all();
}

void CameraLink::Work::wanted(const Parameters& wanted)
{
    const std::lock_guard lock(mutex_);
    settings_.wanted = wanted;
    settings_error_.clear();
}

void CameraLink::Work::restart()
{
    const std::lock_guard lock(mutex_);
    restart_ = true;
}

void CameraLink::Work::once_more()
{
    const std::lock_guard lock(mutex_);
    retry_.retry_once(Clock::now());
    changed_.notify_all();
}

bool CameraLink::Work::login_refused() const
{
    const std::lock_guard lock(mutex_);
    return retry_.login_refused();
}

std::string CameraLink::Work::condition() const
{
    const std::lock_guard lock(mutex_);
    return current_condition();
}

CameraLink::CameraLink(LinkSettings settings, LinkHooks hooks)
    : work_(std::make_shared<Work>(std::move(settings), std::move(hooks))), thread_(work_)
{
}

std::optional<Frame> CameraLink::take() { return work_->take(); }
void CameraLink::ask() { work_->ask(); }
void CameraLink::wanted(const Parameters& wanted) { work_->wanted(wanted); }
void CameraLink::restart() { work_->restart(); }
void CameraLink::once_more() { work_->once_more(); }
bool CameraLink::login_refused() const { return work_->login_refused(); }
std::string CameraLink::condition() const { return work_->condition(); }

}  // namespace axis
