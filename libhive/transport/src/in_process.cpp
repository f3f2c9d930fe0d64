// The in-process transport: names that are met inside one process, for tests.
#include "admissions.hpp"
#include "dial_attempt.hpp"
#include "make_connection.hpp"
#include "memory_pipe.hpp"
#include "schemes.hpp"

#include <asio/post.hpp>

#include <deque>
#include <map>
#include <mutex>

namespace hive::transport {
namespace {

/// Where those who dial a name arrive. On the thread of its context.
class Door : public std::enable_shared_from_this<Door> {
public:
    Door(asio::io_context& context, OnConnection on_connection, const Timing& timing)
        : context_(context), on_connection_(std::move(on_connection)), timing_(timing)
    {
    }
    void start()
    {
        admissions_->freed = [self = weak_from_this()] {
            if (const auto door = self.lock())
                asio::post(door->context_, [door] { door->let_in(); });
        };
    }
    void stop()
    {
        stopped_ = true;
        waiting_.clear();
    }
    asio::io_context& context() { return context_; }
    void arrive(std::unique_ptr<Stream> stream)
    {
        if (!stopped_)
            waiting_.push_back(std::move(stream));
        let_in();
    }

private:
    void let_in()
    {
        while (!waiting_.empty() && !admissions_->full()) {
            auto stream = std::move(waiting_.front());
            waiting_.pop_front();
            on_connection_(make_connection(context_, std::move(stream), timing_, admissions_->admit()));
        }
    }

    asio::io_context& context_;
    const OnConnection on_connection_;
    const Timing timing_;
    std::shared_ptr<Admissions> admissions_ = std::make_shared<Admissions>();
    std::deque<std::unique_ptr<Stream>> waiting_;
    bool stopped_ = false;
};

/// The doors of this process. From any thread; a door's context exists while the door is listed.
struct Doors {
    std::mutex mutex;
    std::map<std::string, std::shared_ptr<Door>> by_name;
};

Doors& doors()
{
    static Doors all;
    return all;
}

class InProcessListener final : public Listener {
public:
    InProcessListener(Address address, std::shared_ptr<Door> door)
        : address_(std::move(address)), door_(std::move(door))
    {
        const std::lock_guard lock(doors().mutex);
        if (!doors().by_name.emplace(address_.host, door_).second)
            throw Error(Errc::name_taken, "cannot listen on " + to_text(address_) + ": the name is taken");
        door_->start();
    }
    InProcessListener(const InProcessListener&) = delete;
    InProcessListener& operator=(const InProcessListener&) = delete;
    ~InProcessListener() override
    {
        const std::lock_guard lock(doors().mutex);
        doors().by_name.erase(address_.host);
        door_->stop();
    }
    [[nodiscard]] Address address() const override { return address_; }

private:
    Address address_;
    std::shared_ptr<Door> door_;
};

class InProcessDial final : public DialAttempt {
public:
    using DialAttempt::DialAttempt;

private:
    void begin() override
    {
        const std::lock_guard lock(doors().mutex);
        const auto found = doors().by_name.find(address_.host);
        if (found == doors().by_name.end())
            return fail(Errc::unreachable, "nobody listens there");
        auto& context = found->second->context();
        auto [here, there] = make_memory_pipe(context_, context, to_text(address_));
        asio::post(context, [door = std::weak_ptr(found->second), stream = std::move(there)]() mutable {
            if (const auto open = door.lock())
                open->arrive(std::move(stream));
        });
        succeed(std::move(here));
    }
    void cancel() noexcept override {}
};

}  // namespace

std::unique_ptr<Listener> listen_in_process(asio::io_context& context, const Address& address,
                                            OnConnection on_connection, const Timing& timing, const Security&)
{
    return std::make_unique<InProcessListener>(address,
                                               std::make_shared<Door>(context, std::move(on_connection), timing));
}

void dial_in_process(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
                     const Timing& timing, const Security&)
{
    std::make_shared<InProcessDial>(context, address, std::move(on_dialed), timing)->start(deadline);
}

}  // namespace hive::transport
