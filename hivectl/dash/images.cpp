// Requests a frame of a live source only when a page needs one, so a slow page gets the newest and costs less. A source
// on demand waits for its receivers, so there every frame is received at once.
#include "images.hpp"

#include "own_name.hpp"
#include "run/silence.hpp"
#include "words/places.hpp"

#include <hive/application.hpp>

#include <set>
#include <thread>

namespace hivectl::dash {
namespace {

using namespace std::chrono_literals;

constexpr auto unwatched_after = 4s, silence = 3s;
constexpr auto timeout = 250ms;

/// Larger than all versions from before a pause in receiving the output.
std::uint64_t first_version()
{
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(now).count());
}

}  // namespace

/// One output, on its own thread: a drone that does not answer delays no other image.
class Images::Source {
public:
    Source(std::filesystem::path home, std::string output, std::function<void()> ready, Time now)
        : home_(std::move(home)), output_(std::move(output)), ready_(std::move(ready)), looked_(now)
    {
        thread_ = std::thread([this] { run(); });
    }
    ~Source()
    {
        end();
        thread_.join();
    }
    Source(const Source&) = delete;
    Source& operator=(const Source&) = delete;

    Newest newest(int width, std::uint64_t after, Time now)
    {
        const std::lock_guard lock(mutex_);
        looked_ = now;
        widths_[width] = now;
        const auto found = ready_for_.find(width);
        wanted_ = wanted_ || found == ready_for_.end() || after >= found->second.version;
        wake_.notify_all();
        return problem_.empty() && found != ready_for_.end() ? found->second : Newest{0, {}, {}, problem_};
    }
    void end()
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
        wake_.notify_all();
    }
    [[nodiscard]] bool ended() const { return ended_; }

private:
    void run();
    void receive();
    bool wait_until_wanted();
    [[nodiscard]] bool looked_at() const;  ///< with the lock
    [[nodiscard]] bool is_looked_at() const { return (std::lock_guard(mutex_), looked_at()); }
    [[nodiscard]] bool is_wanted() const { return (std::lock_guard(mutex_), wanted_); }
    void show(const hive::Event& event);
    void report(const std::string& problem);

    const std::filesystem::path home_;
    const std::string output_;
    const std::function<void()> ready_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    bool ending_ = false, wanted_ = true;
    Time looked_;
    std::map<int, Time> widths_;  ///< that pages use, and the time of their last request
    std::map<int, Newest> ready_for_;
    std::string problem_;
    std::uint64_t version_ = first_version();
    std::atomic<bool> ended_{false};
    std::thread thread_;
};

bool Images::Source::looked_at() const
{
    return !ending_ && std::chrono::steady_clock::now() - looked_ < unwatched_after;
}

void Images::Source::report(const std::string& problem)
{
    {
        const std::lock_guard lock(mutex_);
        problem_ = problem;
    }
    ready_();
}

void Images::Source::run()
{
    while (is_looked_at())
        try {
            receive();
        } catch (const std::exception& error) {  // a drone that is restarting, or an image that cannot be shown
            report(error.what());
            std::unique_lock lock(mutex_);
            wake_.wait_for(lock, 1s, [this] { return ending_; });
        }
    ended_ = true;
}

/// False: no page shows it any more.
bool Images::Source::wait_until_wanted()
{
    std::unique_lock lock(mutex_);
    while (looked_at() && !wanted_)
        wake_.wait_for(lock, timeout);
    return looked_at();
}

void Images::Source::receive()
{
    hive::Application application(
        {.name = own_name(), .home = home_, .timeout = 2s, .cancelled = [this] { return !is_looked_at(); }});
    const auto output = application.endpoint(output_);
    hive::CollectOptions options;
    options.connection.window = 1;
    options.connection.first_frame = true;
    if (is_elsewhere(application.place(output.drone)))
        options.connection.encoding = "jpeg";
    const auto collector = application.collect({output}, options);
    auto last = std::chrono::steady_clock::now();
    std::optional<hive::Event> held;  // while it is held, the sender keeps only its newest event for us
    for (bool lossless = false; lossless ? is_looked_at() : wait_until_wanted();) {
        held.reset();
        auto next = collector->next(timeout);
        const auto now = std::chrono::steady_clock::now();
        if (!next && now - last > silence)
            report(silence_reason(application, {output}));
        if (!next && now - last <= silence)
            continue;
        last = now;
        if (!next)
            continue;
        lossless = next->identity.lossless;
        if (is_wanted())
            show(*next);
        if (!lossless)
            held = std::move(next);
    }
}

/// Encodes it for each width, without the lock.
void Images::Source::show(const hive::Event& event)
{
    std::set<int> widths;
    {
        const std::lock_guard lock(mutex_);
        std::erase_if(widths_, [&](const auto& row) { return looked_ - row.second > unwatched_after; });
        for (const auto& [width, when] : widths_)
            widths.insert(width);
        wanted_ = false;
        ++version_;
    }
    std::map<int, Newest> made;
    for (const int width : widths) {
        auto image = image_for_page(event, width);
        made[width] = {version_, std::move(image.type),
                       std::make_shared<const std::vector<unsigned char>>(std::move(image.bytes)), ""};
    }
    {
        const std::lock_guard lock(mutex_);
        ready_for_ = std::move(made);
        problem_.clear();
    }
    ready_();
}

Images::Images(std::filesystem::path home, std::function<void()> ready)
    : home_(std::move(home)), ready_(std::move(ready))
{
}
Images::~Images()
{
    for (const auto& [output, source] : sources_)  // stop all before joining any
        source->end();
}

Images::Newest Images::newest(const std::string& output, int width, std::uint64_t after, Time now)
{
    std::erase_if(sources_, [](const auto& row) { return row.second->ended(); });
    auto found = sources_.find(output);
    if (found == sources_.end()) {
        if (sources_.size() >= max_outputs)
            return {0, {}, {}, "more than " + std::to_string(max_outputs) + " outputs are shown"};
        found = sources_.emplace(output, std::make_unique<Source>(home_, output, ready_, now)).first;
    }
    return found->second->newest(width, after, now);
}

}  // namespace hivectl::dash
