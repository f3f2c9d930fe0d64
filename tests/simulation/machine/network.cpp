// Listens and dials in the simulated network, for every scheme.
#include "network.hpp"
#include "pipe.hpp"

#include "admissions.hpp"
#include "dial_attempt.hpp"
#include "make_connection.hpp"
#include "schemes.hpp"

#include <hive/transport/port_holder.hpp>

#include <asio/post.hpp>

#include <deque>
#include <fstream>
#include <map>

namespace hive::transport {
namespace {

using namespace std::chrono_literals;
using simulation::NetworkSide;
using simulation::Pipe;
using simulation::Process;
using simulation::world;

/// A dialer that has not been accepted yet.
class Door : public std::enable_shared_from_this<Door> {
public:
    Door(asio::io_context& context, OnConnection on_connection, const Timing& timing)
        : context_(context),
          process_(NetworkSide::of(context).process),
          on_connection_(std::move(on_connection)),
          timing_(timing)
    {
    }

    void open()
    {
        admissions_->freed = [weak = weak_from_this()] {
            if (const auto self = weak.lock())
                asio::post(self->context_, [self] { self->let_in(); });
        };
    }
    void shut()
    {
        shut_ = true;
        waiting_.clear();
    }
    [[nodiscard]] bool is_open() const { return !shut_ && !process_.dead; }
    [[nodiscard]] Process& process() { return process_; }
    [[nodiscard]] asio::io_context& context() { return context_; }
    void knock(std::unique_ptr<Stream> stream)
    {
        waiting_.push_back(std::move(stream));
        NetworkSide::of(context_).post([self = shared_from_this()] { self->let_in(); });
    }

private:
    void let_in()
    {
        while (!shut_ && !waiting_.empty() && !admissions_->full()) {
            auto stream = std::move(waiting_.front());
            waiting_.pop_front();
            on_connection_(make_connection(context_, std::move(stream), timing_, admissions_->admit()));
        }
    }

    asio::io_context& context_;
    Process& process_;
    const OnConnection on_connection_;
    const Timing timing_;
    const std::shared_ptr<Admissions> admissions_ = std::make_shared<Admissions>();
    std::deque<std::unique_ptr<Stream>> waiting_;
    bool shut_ = false;
};

/// By address. Emptied by the listeners; one of a dead process is not open.
std::map<std::string, std::weak_ptr<Door>>& doors()
{
    static std::map<std::string, std::weak_ptr<Door>> all;
    return all;
}

std::shared_ptr<Door> door_at(const Address& address)
{
    const auto found = doors().find(to_text(address));
    const auto door = found == doors().end() ? nullptr : found->second.lock();
    return door && door->is_open() ? door : nullptr;
}

class DoorListener final : public Listener {
public:
    DoorListener(Address address, std::shared_ptr<Door> door) : address_(std::move(address)), door_(std::move(door))
    {
        if (door_at(address_))
            throw Error(Errc::name_taken, "cannot listen on " + to_text(address_) + ": it is taken");
        doors()[to_text(address_)] = door_;
        door_->open();
        if (address_.scheme == Address::Scheme::unix_socket)
            std::ofstream(address_.host).put(' ');  // listing drones reads the files of their sockets
    }
    ~DoorListener() override
    {
        door_->shut();
        if (door_->process().dead)
            return;  // its file stays
        doors().erase(to_text(address_));
        if (std::error_code ignored; address_.scheme == Address::Scheme::unix_socket)
            std::filesystem::remove(address_.host, ignored);
    }
    [[nodiscard]] Address address() const override { return address_; }

private:
    Address address_;
    std::shared_ptr<Door> door_;
};

void note(Process& process, int end, const std::shared_ptr<Pipe>& pipe, Process& peer)
{
    std::erase_if(process.connections, [](const auto& each) { return each.pipe.expired(); });
    process.connections.push_back({end, pipe, &peer});
    if (process.said)
        pipe->rewrite(end, process.said());
}

/// When the two hear each other.
simulation::Time heard_at(const Process& one, const Process& other)
{
    const auto way = [](const Process& from, const Process& to) {
        const auto found = from.unheard.find(to.pid);
        return std::max(found == from.unheard.end() ? simulation::Time() : found->second,
                        world().parted_until(from.machine, to.machine));
    };
    return std::max(way(one, other), way(other, one));
}

class Dial final : public DialAttempt {
public:
    using DialAttempt::DialAttempt;

private:
    void begin() override { arrive_at(world().now() + world().between(20us, 200us)); }
    void cancel() noexcept override {}

    void arrive_at(simulation::Time time)
    {
        const std::weak_ptr operation =
            NetworkSide::of(context_).begin([self = std::static_pointer_cast<Dial>(shared_from_this())](
                                                std::error_code, std::size_t) { self->arrive(); });
        world().at(time, [operation] {
            if (const auto still = operation.lock())
                still->finish({});
        });
    }

    void arrive()
    {
        if (answered())
            return;
        const auto door = door_at(address_);
        if (!door)
            return fail(Errc::unreachable, "connection refused");
        Process& here = NetworkSide::of(context_).process;
        if (const auto heard = heard_at(here, door->process()); heard > world().now())
            return arrive_at(heard);
        const bool local = address_.scheme != Address::Scheme::tcp && here.machine == door->process().machine;
        constexpr std::size_t room = 208 * 1024;
        const auto pipe =
            std::make_shared<Pipe>(local ? Pipe::Nature{50us, 100us, room} : Pipe::Nature{2ms, 3ms, room});
        note(here, 0, pipe, door->process());
        note(door->process(), 1, pipe, here);
        door->knock(simulation::make_stream(door->context(), pipe, 1, here.pid, local));
        succeed(simulation::make_stream(context_, pipe, 0, door->process().pid, local));
    }
};

std::unique_ptr<Listener> listen_anywhere(asio::io_context& context, const Address& address, OnConnection on_connection,
                                          const Timing& timing, const Security&)
{
    return std::make_unique<DoorListener>(address, std::make_shared<Door>(context, std::move(on_connection), timing));
}

void dial_anywhere(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
                   const Timing& timing, const Security&)
{
    std::make_shared<Dial>(context, address, std::move(on_dialed), timing)->start(deadline);
}

}  // namespace

std::unique_ptr<Listener> listen_tcp(asio::io_context& context, const Address& address, OnConnection on_connection,
                                     const Timing& timing, const Security& security)
{
    return listen_anywhere(context, address, std::move(on_connection), timing, security);
}

std::unique_ptr<Listener> listen_unix(asio::io_context& context, const Address& address, OnConnection on_connection,
                                      const Timing& timing, const Security& security)
{
    return listen_anywhere(context, address, std::move(on_connection), timing, security);
}

void dial_tcp(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
              const Timing& timing, const Security& security)
{
    dial_anywhere(context, address, deadline, std::move(on_dialed), timing, security);
}

void dial_unix(asio::io_context& context, const Address& address, Milliseconds deadline, OnDialed on_dialed,
               const Timing& timing, const Security& security)
{
    dial_anywhere(context, address, deadline, std::move(on_dialed), timing, security);
}

std::string holder_of_port(std::uint16_t) { return {}; }

}  // namespace hive::transport

namespace hive::simulation {

void close_connections_of(Process& process)
{
    for (const auto& connection : std::exchange(process.connections, {}))
        if (const auto pipe = connection.pipe.lock())
            pipe->close(connection.end);
}

namespace {

std::optional<Process::Connection> one_connection(const Process& process,
                                                  const std::function<bool(const Process&)>& with)
{
    auto candidates = process.connections;
    std::erase_if(candidates, [&](const auto& each) { return each.pipe.expired() || !with(*each.peer); });
    if (candidates.empty())
        return {};
    return candidates[world().chance_of(candidates.size())];
}

}  // namespace

std::string cut_one_connection(Process& process, const std::function<bool(const Process&)>& with)
{
    const auto connection = one_connection(process, with);
    if (!connection)
        return {};
    connection->pipe.lock()->cut();
    return connection->peer->name;
}

void part_machines(int from, int to, Time until)
{
    world().part(from, to, until);
    for (const auto& process : world().processes())
        for (const auto& each : process->connections)
            if (const auto pipe = each.pipe.lock(); pipe && process->machine == from && each.peer->machine == to)
                pipe->hold(each.end, until);
}

std::string silence_one_connection(Process& process, const std::function<bool(const Process&)>& with, Time until)
{
    const auto connection = one_connection(process, with);
    if (!connection)
        return {};
    const bool here = world().chance(50);
    Process &from = here ? process : *connection->peer, &to = here ? *connection->peer : process;
    from.unheard[to.pid] = until;
    for (const auto& each : from.connections)
        if (const auto pipe = each.pipe.lock(); pipe && each.peer == &to)
            pipe->hold(each.end, until);
    return connection->peer->name;
}

}  // namespace hive::simulation
