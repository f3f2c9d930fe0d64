// An application and its collectors behind handles: lets in one thread at a time, first come, first served.
#pragma once

#include "texts.hpp"

#include "handles.hpp"

#include <hive/application.hpp>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace hive::c {

/// How long one thread waits for events before it lets others in.
constexpr std::chrono::milliseconds longest_turn(50);

/// A fair lock: threads enter in the order of their calls.
class Queue {
public:
    /// Throws Errc::invalid_argument on the thread inside, and Errc::stopped if the caller cancels the wait.
    void enter();
    /// The same, without a way to cancel.
    void enter_in_any_case();
    void leave();
    [[nodiscard]] bool is_in() const;

private:
    mutable std::mutex mutex_;
    std::condition_variable left_;
    std::uint64_t asked_ = 0, served_ = 0;
    std::set<std::uint64_t> gone_;  ///< waiting threads that cancelled
    std::thread::id in_{};

    std::uint64_t ask();
    void pass_on();
};

class ApplicationObject;

/// A Collector or a MatchedCollector: one of the two is set until it is closed.
class CollectorObject final : public Object, public std::enable_shared_from_this<CollectorObject> {
public:
    using Handle = hive_collector;
    static constexpr const char* name = "hive_collector";

    explicit CollectorObject(std::shared_ptr<ApplicationObject> of) : application(std::move(of)) {}
    void released() override;

    const std::shared_ptr<ApplicationObject> application;
    // For the thread inside.
    std::unique_ptr<Collector> events;
    std::unique_ptr<MatchedCollector> sets;
    bool closed = false;
};

class ApplicationObject final : public Object, public std::enable_shared_from_this<ApplicationObject> {
public:
    using Handle = hive_application;
    static constexpr const char* name = "hive_application";

    explicit ApplicationObject(Application::Options options);
    void released() override;

    /// Lets this thread in and runs the function. Throws Errc::stopped if the application is closed.
    void with(const std::function<void(Application&)>& work);
    /// The same for one of its collectors.
    void with(CollectorObject& collector, const std::function<void()>& work);
    /// Destroys its collectors, then itself.
    void close();
    void close(const std::shared_ptr<CollectorObject>& collector);

    [[nodiscard]] std::shared_ptr<CollectorObject> new_collector();
    /// Lets other threads in for this long, or until one closes the application.
    void rest(std::chrono::milliseconds time);
    /// Is another thread waiting to close it?
    [[nodiscard]] bool is_closing();
    [[nodiscard]] const std::string& application_name() const noexcept { return name_; }
    [[nodiscard]] std::chrono::milliseconds timeout() const;
    void timeout(std::chrono::milliseconds timeout);

private:
    void leave();
    void close_now();

    Queue queue_;
    // For the thread inside.
    std::unique_ptr<Application> application_;
    std::vector<std::weak_ptr<CollectorObject>> collectors_;
    std::chrono::milliseconds timeout_;
    // Released by the thread inside, from within a callback: destroyed when it leaves.
    std::mutex mutex_;
    std::condition_variable closing_;
    std::vector<std::shared_ptr<CollectorObject>> doomed_;
    bool all_doomed_ = false;
    std::string name_;
};

/// Runs with the application of a handle, one thread at a time.
template <class Function>
hive_code with_application(hive_application* application, Function&& function)
{
    return guarded([&] { get<ApplicationObject>(application)->with(function); });
}

/// {"code", "text", "advice"}
Json error_json(const Error& error);
/// "camera.image"
/// {"drone", "host", "address", "ssh", "answered_us"}
Json place_json(const Place& place);
ConnectionOptions connection_of(const Json& given, const ConnectionOptions& fallback = {});
CollectOptions collect_options(const char* text);

}  // namespace hive::c
