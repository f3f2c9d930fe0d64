#include "watch.hpp"

#include "layout.hpp"
#include "own_name.hpp"
#include "run/drawing.hpp"
#include "words/output.hpp"

#include <hive/transport/key.hpp>

namespace hivectl::dash {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds every_look = 1s, idle_after = 4s;
constexpr std::chrono::milliseconds second_look = 300ms;  ///< rates and explanations need two

/// With the viewers' key, drones of other machines permit reading only.
bool have_viewers_key()
try {
    const auto file = hive::default_key_file();
    return !file.empty() && hive::read_key_file(file).front().role == hive::Role::viewer;
} catch (const hive::Error&) {  // no such key
    return false;
}

}  // namespace

Watch::Watch(std::filesystem::path home, std::chrono::milliseconds timeout, std::function<void()> changed)
    : home_(std::move(home)), timeout_(timeout), changed_(std::move(changed))
{
    looker_ = std::thread([this] { run(&Watch::look); });
    explainer_ = std::thread([this] { run(&Watch::explain); });
}

Watch::~Watch()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_all();
    looker_.join();
    explainer_.join();
}

std::shared_ptr<const Snapshot> Watch::newest(Time now)
{
    const std::lock_guard lock(mutex_);
    if (now - looked_ > idle_after)
        wake_.notify_all();
    looked_ = std::max(looked_, now);
    return newest_;
}

std::shared_ptr<const Watch::Drawing> Watch::drawing() const
{
    const std::lock_guard lock(mutex_);
    return drawing_;
}

/// False: stop.
bool Watch::wait_for_looker(Time not_before)
{
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, not_before, [this] { return ending_; });
    wake_.wait(lock, [this] { return ending_ || std::chrono::steady_clock::now() - looked_ <= idle_after; });
    return !ending_;
}

void Watch::run(Turn turn)
{
    hive::Application application({.name = own_name(), .home = home_, .timeout = timeout_, .cancelled = [this] {
                                       const std::lock_guard lock(mutex_);
                                       return ending_;
                                   }});
    auto pause = 0ms;
    for (Time next{}; wait_for_looker(next); next = std::chrono::steady_clock::now() + pause)
        try {
            pause = (this->*turn)(application);
        } catch (const std::exception& error) {  // the next turn may succeed
            pause = every_look;
            complain("dash", error.what());
        }
}

std::chrono::milliseconds Watch::look(hive::Application& application)
{
    auto crashed = hive::crashed(application);  // first: a drone that is restarted meanwhile has a status
    auto answers = application.status(application.drones());
    const auto now = std::chrono::steady_clock::now();
    const bool paused = !looks_.empty() && now - looks_.back().at > idle_after + timeout_;  // no page was open
    if (paused)
        looks_.clear();
    {
        const std::lock_guard lock(mutex_);
        if (paused)
            worst_ = {};
        before_ = paused ? nullptr : std::move(last_);
        last_ = std::make_shared<const Query>(answers, now);
    }
    remove_pages(answers);
    looks_.push_back({std::move(answers), now});
    if (looks_.size() > 3)
        looks_.pop_front();
    const std::array<Look, 3> three{looks_.front(), looks_[(looks_.size() - 1) / 2], looks_.back()};
    const auto graph = hive::graph(three[2].answers, std::move(crashed));
    auto snapshot = std::make_shared<Snapshot>(snapshot_of(three, graph));
    remember(past_, *snapshot);
    snapshot->past = past_;
    draw(graph);
    auto bar = bar_of(three);
    bar["viewer"] = have_viewers_key();
    {
        const std::lock_guard lock(mutex_);
        snapshot->version = newest_ ? newest_->version + 1 : 1;
        bar["worst"] = worst_;
        snapshot->text = json_text({{"version", snapshot->version},
                                    {"hivectl", HIVECTL_VERSION},
                                    {"drawing", drawing_->version},
                                    {"bar", bar},
                                    {"drones", snapshot->drones},
                                    {"edges", snapshot->edges}});
        newest_ = std::move(snapshot);
    }
    changed_();
    return looks_.size() < 2 ? second_look : every_look;
}

std::chrono::milliseconds Watch::explain(hive::Application& application)
{
    std::shared_ptr<const Query> before, last;
    {
        const std::lock_guard lock(mutex_);
        before = before_;
        last = last_;
    }
    const auto outdated = [&] { return std::chrono::steady_clock::now() - last->at > idle_after + timeout_; };
    if (!before || last == explained_ || outdated())
        return second_look;
    explained_ = last;
    const auto explanation = hive::explain_answers(application, before->answers, last->answers);
    const auto& causes = explanation.causes;
    auto worst = causes.empty() || outdated() ? hive::Json() : to_json(causes.front());
    const std::lock_guard lock(mutex_);
    worst_ = std::move(worst);
    return second_look;
}

/// Graphviz takes seconds for a large swarm; the numbers are updated meanwhile.
void Watch::draw(const hive::SwarmGraph& graph)
{
    auto dot = dot_of(graph);
    if (dot == drawn_ || (drawer_.valid() && drawer_.wait_for(0s) != std::future_status::ready))
        return;
    drawn_ = dot;
    drawer_ = std::async(std::launch::async, [this, dot = std::move(dot)] {
        Drawing drawing;
        try {
            drawing.svg = svg_of(dot);
        } catch (const hive::Error& error) {
            drawing.problem = std::string(error.what()) + (error.advice().empty() ? "" : "; " + error.advice());
        }
        const std::lock_guard lock(mutex_);
        drawing.version = drawing_->version + 1;
        drawing_ = std::make_shared<const Drawing>(std::move(drawing));
    });
}

}  // namespace hivectl::dash
