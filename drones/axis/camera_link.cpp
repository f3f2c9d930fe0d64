// The link's thread. Everything it touches is in Shared, which it keeps alive itself.
#include "camera_link.hpp"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace axis {
namespace {

using namespace std::chrono_literals;
using Clock = Lifeline::Clock;
constexpr std::chrono::milliseconds end_within{500}, look_at_credentials{1000}, give_up_without_picture{10'000};

/// Ends a session that shall begin anew at once.
struct Restart {};

}  // namespace

struct CameraLink::Shared {
    explicit Shared(LinkSettings all, LinkHooks them) : settings(std::move(all)), hooks(std::move(them)) {}

    LinkSettings settings;  // of the thread alone, but for `wanted`
    LinkHooks hooks;        // notice and log: under the mutex, so that they end with the link
    std::filesystem::file_time_type credentials_written = written_at(settings.credentials_path);
    std::int64_t count = 0;
    Clock::time_point last_picture{};

    mutable std::mutex mutex;  // for all below
    std::condition_variable changed;
    bool stopping = false, ended = false, asked = false, restart = false;
    std::optional<Picture> newest;
    Lifeline lifeline{Clock::now()};
    std::string settings_trouble, last_told, greeting;

    void run();
    void session();
    void set_up(Camera& camera);
    void greet(const Model& model);
    void live(Camera& camera);
    void on_demand(Camera& camera);
    void accept(std::string bytes);
    void check();
    void pause();
    void look_for_credentials();

    [[nodiscard]] bool is_stopping() const
    {
        const std::lock_guard lock(mutex);
        return stopping;
    }

    /// The mutex is held.
    [[nodiscard]] std::string told() const
    {
        const std::string trouble = lifeline.condition(Clock::now());
        return trouble.empty() ? settings_trouble : trouble;
    }

    void notice_news()
    {
        const std::lock_guard lock(mutex);
        const std::string text = told();
        if (!stopping && std::exchange(last_told, text) != text)
            hooks.notice();
    }
};

void CameraLink::Shared::run()
{
    while (!is_stopping()) {
        try {
            session();
        } catch (const Restart&) {
        } catch (const CameraError& error) {
            const std::lock_guard again(mutex);
            lifeline.failed(error, Clock::now());
        } catch (const std::exception& error) {
            const std::lock_guard again(mutex);
            lifeline.failed(CameraError(Trouble::refused_status, error.what()), Clock::now());
        }
        notice_news();
        pause();
    }
    const std::lock_guard lock(mutex);
    ended = true;
    changed.notify_all();
}

void CameraLink::Shared::session()
{
    last_picture = Clock::now();
    Camera camera(settings.access, [this] { check(); });
    set_up(camera);
    settings.pace == Pace::live ? live(camera) : on_demand(camera);
}

/// An anonymous viewer may see pictures, but perhaps no parameters: the pictures decide then.
void CameraLink::Shared::set_up(Camera& camera)
{
    Parameters wanted;
    {
        const std::lock_guard lock(mutex);
        lifeline.expect(Clock::now());
        restart = false;
        wanted = settings.wanted;
    }
    std::string trouble;
    try {
        greet(camera.identify());
        camera.apply(wanted);
    } catch (const CameraError& error) {
        const bool anonymous = error.trouble() == Trouble::login_needed && !settings.access.credentials;
        if (!anonymous && error.trouble() != Trouble::setting_refused)
            throw;
        if (!wanted.empty())
            trouble = error.what();
    }
    const std::lock_guard lock(mutex);
    settings_trouble = trouble;
}

/// A camera that comes and goes is named once.
void CameraLink::Shared::greet(const Model& model)
{
    const std::string text =
        masked("connected to " + model.name + ", firmware " + model.firmware + ", serial number " + model.serial);
    const std::lock_guard lock(mutex);
    if (!stopping && std::exchange(greeting, text) != text)
        hooks.log(text);
}

void CameraLink::Shared::live(Camera& camera)
{
    camera.stream([this](Part part) { accept(std::move(part.bytes)); });
}

void CameraLink::Shared::on_demand(Camera& camera)
{
    while (true) {
        {
            std::unique_lock lock(mutex);
            if (!asked)
                lifeline.content();
            changed.wait(lock, [&] { return asked || stopping; });
            lifeline.expect(Clock::now());
        }
        check();
        accept(camera.snapshot());
    }
}

/// What is not whole is never passed on.
void CameraLink::Shared::accept(std::string bytes)
{
    Picture picture{.jpeg = {}, .size = {}, .index = count, .captured = std::chrono::system_clock::now()};
    try {
        picture.size = hooks.measure(bytes);
    } catch (const std::exception& problem) {
        const std::lock_guard lock(mutex);
        lifeline.broken(std::string("no whole picture: ") + problem.what());
        if (settings.pace == Pace::demand)
            throw CameraError(Trouble::not_a_picture, std::string("no whole picture: ") + problem.what());
        return;
    }
    picture.jpeg = std::make_shared<const std::string>(std::move(bytes));
    ++count;
    last_picture = Clock::now();
    const std::lock_guard lock(mutex);
    lifeline.picture(last_picture);
    asked = false;
    newest = std::move(picture);
    last_told = told();
    if (!stopping)
        hooks.notice();
}

/// Ten times a second while the network is waited for.
void CameraLink::Shared::check()
{
    notice_news();
    if (Clock::now() - last_picture > give_up_without_picture && settings.pace == Pace::live)
        throw CameraError(Trouble::silent, "bytes, but no picture");
    const std::lock_guard lock(mutex);
    if (stopping)
        throw CameraError(Trouble::cancelled, "not wanted any more");
    if (std::exchange(restart, false))
        throw Restart();
}

/// Until the next try is due.
void CameraLink::Shared::pause()
{
    std::unique_lock lock(mutex);
    while (!stopping && lifeline.locked_out()) {
        changed.wait_for(lock, look_at_credentials, [&] { return stopping || !lifeline.locked_out(); });
        lock.unlock();
        look_for_credentials();
        lock.lock();
    }
    changed.wait_until(lock, lifeline.next_try(), [&] { return stopping; });
}

void CameraLink::Shared::look_for_credentials()
{
    try {
        auto now = read_credentials(settings.credentials_path);
        const auto written = written_at(settings.credentials_path);
        if (now == settings.access.credentials && written == credentials_written)
            return;
        settings.access.credentials = std::move(now);
        credentials_written = written;
        const std::lock_guard lock(mutex);
        lifeline.new_credentials(Clock::now());
    } catch (const std::exception&) {  // it is being written, or gone: what is said already stays true
    }
}

CameraLink::CameraLink(LinkSettings settings, LinkHooks hooks)
    : shared_(std::make_shared<Shared>(std::move(settings), std::move(hooks)))
{
    thread_ = std::thread([shared = shared_] { shared->run(); });
}

CameraLink::~CameraLink()
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

std::optional<Picture> CameraLink::take()
{
    const std::lock_guard lock(shared_->mutex);
    return std::exchange(shared_->newest, std::nullopt);
}

void CameraLink::ask()
{
    const std::lock_guard lock(shared_->mutex);
    shared_->asked = shared_->asked || !shared_->newest;
    shared_->changed.notify_all();
}

void CameraLink::wanted(const Parameters& wanted)
{
    const std::lock_guard lock(shared_->mutex);
    shared_->settings.wanted = wanted;
    shared_->settings_trouble.clear();
}

void CameraLink::restart()
{
    const std::lock_guard lock(shared_->mutex);
    shared_->restart = true;
}

void CameraLink::once_more()
{
    const std::lock_guard lock(shared_->mutex);
    shared_->lifeline.once_more(Clock::now());
    shared_->changed.notify_all();
}

bool CameraLink::login_refused() const
{
    const std::lock_guard lock(shared_->mutex);
    return shared_->lifeline.login_refused();
}

std::string CameraLink::condition() const
{
    const std::lock_guard lock(shared_->mutex);
    return shared_->told();
}

}  // namespace axis
