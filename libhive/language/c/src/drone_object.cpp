// Owns a drone, and checks the thread and time of each call.
#include "drone_object.hpp"

#include "texts.hpp"

namespace hive::c {

namespace {

/// The last reference may be released on a thread that the drone's destructor joins, such as its encoder's.
void end(EmbeddedDrone* drone)
{
    if (LibraryThread::is_this())
        std::thread([drone] { delete drone; }).detach();
    else
        delete drone;
}

}  // namespace

void LogSink::set(Write write)
{
    const std::lock_guard lock(mutex_);
    write_ = std::make_shared<Write>(std::move(write));
}

/// Under the lock, so that the previous callback is not running when set() has returned.
void LogSink::write(LogLevel level, const std::string& line)
{
    const std::lock_guard lock(mutex_);
    const LibraryThread here;
    if (const auto write = write_; *write)  // it may release the drone, and with it the arguments of set()
        (*write)(level, line.c_str());
}

Json Variable::value() const
{
    if (integer)
        return *integer;
    if (number)
        return *number;
    return flag ? Json(*flag) : Json(*text);
}

void Variable::assign(const Json& value) const
{
    if (integer)
        *integer = value.get<int>();
    else if (number)
        *number = value.get<double>();
    else if (flag)
        *flag = value.get<bool>();
    else
        *text = value.get<std::string>();
    show();
}

void Variable::show() const
{
    if (shown)
        *shown = text->c_str();
}

void Variable::take() const
{
    if (shown && *shown != text->c_str())
        *text = text_or_empty(*shown);
    show();
}

DroneObject::DroneObject(DroneProgram program, EmbeddedOptions options)
{
    options.log = [log = log_](LogLevel level, const std::string& line) { log->write(level, line); };
    drone_.reset(new EmbeddedDrone(std::move(program), std::move(options)), end);
    watch_changes();
}

DroneObject::DroneObject(std::unique_ptr<EmbeddedDrone> drone) : drone_(drone.release(), end) { watch_changes(); }

/// The drone calls the callbacks and never outlives this object: a running thread holds both.
void DroneObject::watch_changes()
{
    drone_->drone().on_change([this] {
        for (const auto& variable : variables_)
            variable.show();
        if (on_change_.callback)
            call([this] { return on_change_.callback(on_change_.user); });
        for (const auto& variable : variables_)
            variable.take();
    });
}

void DroneObject::released()
{
    std::shared_ptr<EmbeddedDrone> last;
    {
        const std::lock_guard lock(mutex_);
        last = std::move(drone_);
    }
    log_->set({});
    try {
        if (inside_)
            last->drone().stop();  // the thread that runs it destroys it afterwards
    } catch (const Error&) {
        // Not yet running: it ends when on_start has returned.
    }
}

std::shared_ptr<EmbeddedDrone> DroneObject::open() const
{
    const std::lock_guard lock(mutex_);
    if (!drone_)
        throw Error(Errc::stopped, "the drone was released");
    return drone_;
}

std::shared_ptr<EmbeddedDrone> DroneObject::declaring() const
{
    if (began_)
        throw Error(Errc::invalid_argument, "the drone has already started");
    return open();
}

std::shared_ptr<EmbeddedDrone> DroneObject::on_user_thread() const
{
    auto drone = open();
    const auto user = user_thread_.load();
    if (user != std::thread::id() && user != std::this_thread::get_id())
        throw Error(Errc::invalid_argument, "this is for the thread that runs the drone");
    return drone;
}

void DroneObject::as_user_thread(const std::function<void(EmbeddedDrone&)>& work)
{
    const auto drone = open();
    if (inside_.exchange(true))
        throw Error(Errc::invalid_argument, "the drone runs already");
    struct Leave {
        std::atomic<bool>& inside;
        ~Leave() { inside = false; }
    } const leave{inside_};
    user_thread_ = std::this_thread::get_id();
    work(*drone);
}

Json DroneObject::values() const
{
    Json values = Json::object();
    for (const auto& variable : variables_)
        values[variable.name] = variable.value();
    return values;
}

/// All or none: each is checked before the first one changes.
void DroneObject::assign(const Json& values)
{
    const auto interface = open()->interface();
    std::vector<std::pair<const Variable*, Json>> changes;
    for (const auto& [wanted, value] : values.items()) {
        const auto* parameter = interface.parameter(wanted);
        if (!parameter)
            throw Error(Errc::not_found, "no parameter " + in_quotes(wanted));
        for (const auto& variable : variables_)
            if (variable.name == wanted)
                changes.emplace_back(&variable, checked_value(*parameter, value));
    }
    for (const auto& [variable, value] : changes)
        variable->assign(value);
}

void DroneObject::call(const std::function<hive_code()>& callback)
{
    failure_ = nullptr;
    forget_error();
    const hive_code code = callback();
    const auto failure = std::exchange(failure_, nullptr);
    if (code != HIVE_OK && failure)
        std::rethrow_exception(failure);
    require_done(code);
}

Match match_of(const char* text)
{
    const Options options(text, {"tolerance_us"});
    const auto tolerance = options.integer("tolerance_us", 0, -1);
    return tolerance < 0 ? Match::exact() : Match::within(std::chrono::microseconds(tolerance));
}

}  // namespace hive::c
