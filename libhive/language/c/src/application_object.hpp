// An application and its collectors behind handles: one thread at a time is let in, in the order of asking.
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

/// How long one thread waits for events before others are let in.
constexpr std::chrono::milliseconds longest_turn(50);

/// Lets threads in one after the other, first come, first served.
class Queue {
public:
    /// Throws Errc::invalid_argument for the thread that is in already, and Errc::stopped when the caller no longer
    /// wants to wait.
    void enter();
    /// The same for who must get in.
    void enter_in_any_case();
    void leave();
    [[nodiscard]] bool is_in() const;

private:
    mutable std::mutex mutex_;
    std::condition_variable left_;
    std::uint64_t asked_ = 0, served_ = 0;
    std::set<std::uint64_t> gone_;  ///< of those that asked
    std::thread::id in_{};

    std::uint64_t ask();
    void pass_on();
};

class ApplicationObject;

/// One of the two kinds is there until it is closed.
class CollectorObject final : public Object, public std::enable_shared_from_this<CollectorObject> {
public:
    using Handle = hive_collector;
    static constexpr const char* name = "hive_collector";

    explicit CollectorObject(std::shared_ptr<ApplicationObject> of) : application(std::move(of)) {}
    void released() override;

    const std::shared_ptr<ApplicationObject> application;
    // Of the thread that is in the application.
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

    /// Lets this thread in and runs it. Throws Errc::stopped when the application is closed.
    void with(const std::function<void(Application&)>& work);
    /// The same for one of its collectors.
    void with(CollectorObject& collector, const std::function<void()>& work);
    /// Ends its collectors, then itself.
    void close();
    void close(const std::shared_ptr<CollectorObject>& collector);

    [[nodiscard]] std::shared_ptr<CollectorObject> new_collector();
    /// Does another thread wait to close it?
    [[nodiscard]] bool is_closing();
    [[nodiscard]] const std::string& application_name() const noexcept { return name_; }
    [[nodiscard]] std::chrono::milliseconds timeout() const;
    void timeout(std::chrono::milliseconds timeout);

private:
    void leave();
    void close_now();

    Queue queue_;
    // Of the thread that is in.
    std::unique_ptr<Application> application_;
    std::vector<std::weak_ptr<CollectorObject>> collectors_;
    std::chrono::milliseconds timeout_;
    // Released by the thread that is in, from within a callback: ended when it leaves.
    std::mutex mutex_;
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
