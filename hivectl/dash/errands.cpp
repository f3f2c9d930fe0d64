#include "errands.hpp"

#include "own_name.hpp"

#include <system_error>

namespace hivectl::dash {
namespace {

constexpr std::size_t max_results = 256;  // a limit, for pages that were closed meanwhile

/// Destroys the thread's application, and with it all links to drones.
hive::Json result_of(const Errands::Work& work, const hive::Application::Options& options)
try {
    hive::Application application(options);
    return work(application);
} catch (const std::exception&) {
    const auto error = hive::current_error();
    const auto& row = hive::info(error.code());
    return {{"error",
             {{"code", row.token},
              {"text", error.what()},
              {"advice", error.advice().empty() ? std::string(row.advice) : error.advice()}}}};
}

}  // namespace

Errands::Errands(std::filesystem::path home, std::chrono::milliseconds timeout, std::function<void()> done)
    : home_(std::move(home)), timeout_(timeout), done_(std::move(done))
{
}

Errands::~Errands()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    wake_.notify_all();
    for (auto& thread : threads_)
        thread.join();
}

bool Errands::ending() const
{
    const std::lock_guard lock(mutex_);
    return ending_;
}

std::uint64_t Errands::begin(Work work)
{
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= max_waiting)
        return 0;
    waiting_.emplace_back(++begun_, std::move(work));
    try {
        if (idle_ < waiting_.size() && threads_.size() < max_threads)
            threads_.emplace_back([this] { run(); });
    } catch (const std::system_error&) {  // no further thread: the existing ones run it later
        if (threads_.empty()) {
            waiting_.pop_back();
            return 0;
        }
    }
    wake_.notify_one();
    return begun_;
}

std::optional<hive::Json> Errands::take(std::uint64_t errand)
{
    const std::lock_guard lock(mutex_);
    const auto found = results_.find(errand);
    if (found == results_.end())
        return std::nullopt;
    auto result = std::move(found->second);
    results_.erase(found);
    return result;
}

void Errands::run()
{
    for (std::unique_lock lock(mutex_);;) {
        ++idle_;
        wake_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
        --idle_;
        if (ending_)
            return;
        const auto [errand, work] = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        auto result = result_of(
            work, {.name = own_name(), .home = home_, .timeout = timeout_, .cancelled = [this] { return ending(); }});
        lock.lock();
        results_[errand] = std::move(result);
        while (results_.size() > max_results)
            results_.erase(results_.begin());
        done_();
    }
}

}  // namespace hivectl::dash
