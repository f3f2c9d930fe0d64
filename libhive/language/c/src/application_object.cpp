// Serializes the threads of an application, and destroys its parts in order.
#include "application_object.hpp"

#include "texts.hpp"
#include "waiting.hpp"

#include <hive/connection_option.hpp>

#include <algorithm>

namespace hive::c {

/// With the mutex held.
std::uint64_t Queue::ask()
{
    if (in_ == std::this_thread::get_id())
        throw Error(Errc::invalid_argument, "this cannot be called from a callback of the same application");
    return asked_++;
}

/// With the mutex held: lets in the next thread that still waits.
void Queue::pass_on()
{
    do
        ++served_;
    while (gone_.erase(served_) > 0);
    left_.notify_all();
}

void Queue::enter()
{
    std::unique_lock lock(mutex_);
    const auto mine = ask();
    while (!left_.wait_for(lock, longest_turn, [&] { return mine == served_; })) {
        lock.unlock();
        const bool cancelled = wait_is_cancelled();
        lock.lock();
        if (!cancelled)
            continue;
        if (mine == served_)
            pass_on();
        else
            gone_.insert(mine);
        throw Error(Errc::stopped, "cancelled while it waited for a call of another thread");
    }
    in_ = std::this_thread::get_id();
}

void Queue::enter_in_any_case()
{
    std::unique_lock lock(mutex_);
    const auto mine = ask();
    left_.wait(lock, [&] { return mine == served_; });
    in_ = std::this_thread::get_id();
}

void Queue::leave()
{
    const std::lock_guard lock(mutex_);
    in_ = {};
    pass_on();
}

bool Queue::is_in() const
{
    const std::lock_guard lock(mutex_);
    return in_ == std::this_thread::get_id();
}

void CollectorObject::released() { application->close(shared_from_this()); }

ApplicationObject::ApplicationObject(Application::Options options) : timeout_(options.timeout), name_()
{
    application_ = std::make_unique<Application>(std::move(options));
    name_ = application_->name();
}

void ApplicationObject::with(const std::function<void(Application&)>& work)
{
    queue_.enter();
    struct Leave {
        ApplicationObject& object;
        ~Leave() { object.leave(); }
    } const leave{*this};
    if (!application_)
        throw Error(Errc::stopped, "the application is closed", "make a new one");
    work(*application_);
}

void ApplicationObject::with(CollectorObject& collector, const std::function<void()>& work)
{
    with([&](Application&) {
        if (collector.closed)
            throw Error(Errc::stopped, "the collector is closed");
        work();
    });
}

/// Destroys what a callback released meanwhile.
void ApplicationObject::leave()
{
    std::vector<std::shared_ptr<CollectorObject>> doomed;
    bool all = false;
    {
        const std::lock_guard lock(mutex_);
        doomed.swap(doomed_);
        all = all_doomed_;
    }
    for (const auto& collector : doomed) {
        collector->closed = true;
        collector->events.reset();
        collector->sets.reset();
    }
    if (all)
        close_now();
    queue_.leave();
}

void ApplicationObject::close_now()
{
    for (const auto& weak : std::exchange(collectors_, {}))
        if (const auto collector = weak.lock()) {
            collector->closed = true;
            collector->events.reset();
            collector->sets.reset();
        }
    application_.reset();
}

/// Any thread that is let in closes, and so does the thread inside when it leaves.
void ApplicationObject::close()
{
    {
        const std::lock_guard lock(mutex_);
        all_doomed_ = true;
    }
    closing_.notify_all();
    if (queue_.is_in())
        return;
    queue_.enter_in_any_case();
    leave();
}

void ApplicationObject::close(const std::shared_ptr<CollectorObject>& collector)
{
    {
        const std::lock_guard lock(mutex_);
        doomed_.push_back(collector);
    }
    if (queue_.is_in())
        return;
    queue_.enter_in_any_case();
    leave();
}

void ApplicationObject::released() { close(); }

void ApplicationObject::rest(std::chrono::milliseconds time)
{
    std::unique_lock lock(mutex_);
    closing_.wait_for(lock, time, [&] { return all_doomed_; });
}

bool ApplicationObject::is_closing()
{
    const std::lock_guard lock(mutex_);
    return all_doomed_;
}

std::shared_ptr<CollectorObject> ApplicationObject::new_collector()
{
    auto collector = std::make_shared<CollectorObject>(shared_from_this());
    std::erase_if(collectors_, [](const auto& weak) { return weak.expired(); });
    collectors_.push_back(collector);
    return collector;
}

std::chrono::milliseconds ApplicationObject::timeout() const { return timeout_; }

void ApplicationObject::timeout(std::chrono::milliseconds timeout)
{
    with([&](Application& application) {
        timeout_ = timeout;
        application.timeout(timeout);
    });
}

Json error_json(const Error& error)
{
    return {{"code", info(error.code()).token},
            {"text", error.what()},
            {"advice", error.advice().empty() ? std::string(info(error.code()).advice) : error.advice()}};
}

Json place_json(const Place& place)
{
    return {{"drone", place.drone},
            {"host", place.host},
            {"address", place.address},
            {"ssh", place.ssh},
            {"answered_us", place.answered_us}};
}

ConnectionOptions connection_of(const Json& given, const ConnectionOptions& fallback)
try {
    const auto known = connection_option_table();
    Json fields = to_json(fallback);
    for (const auto& [name, value] : given.items()) {
        if (std::ranges::find(known, name, &ConnectionOption::field) == known.end())
            throw Error(Errc::invalid_argument, "a connection has no option " + in_quotes(name));
        fields[name] = value;
    }
    return connection_options(fields);
} catch (const Error& error) {
    throw Error(Errc::invalid_argument, error.what());
}

CollectOptions collect_options(const char* text)
{
    const Options given(text, {"connection", "ordered", "reorder_timeout_ms"});
    CollectOptions options;
    options.connection = connection_of(given.object("connection"), options.connection);
    options.ordered = given.flag("ordered");
    options.reorder_timeout = timeout_of(given.integer("reorder_timeout_ms", 0, options.reorder_timeout.count()));
    return options;
}

}  // namespace hive::c
