// Dials, sends hello, registers, and reconnects.
#include "crowd.hpp"

#include <hive/backoff.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/transport/transport.hpp>

#include <asio/executor_work_guard.hpp>
#include <asio/io_context.hpp>
#include <asio/ip/tcp.hpp>
#include <asio/post.hpp>
#include <asio/steady_timer.hpp>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

namespace hive::test {
namespace crowd {

using namespace std::chrono_literals;
using protocol::PacketType;

/// The address of the drone, and the number of peers.
struct Goal {
    transport::Address address;
    transport::Security security;
    std::atomic<int> served = 0, lost = 0;
    bool over = false;
};

class Guest : public std::enable_shared_from_this<Guest> {
public:
    Guest(asio::io_context& context, Goal& goal, int number)
        : context_(context),
          goal_(goal),
          name_("guest-" + std::to_string(number)),
          backoff_(100ms, 1s, static_cast<std::uint32_t>(number)),
          timer_(context)
    {
    }

    void dial()
    {
        transport::dial(
            context_, goal_.address, 5s,
            [self = shared_from_this()](auto dialed) {
                if (self->goal_.over)
                    return;
                auto connection = value_or_none(std::move(dialed));
                if (!connection)
                    return self->retry();
                self->meet(std::move(connection));
            },
            {}, goal_.security);
    }

    void lose()
    {
        if (connection_)
            connection_->close({Errc::connection_lost, "it was told to"});
    }

private:
    void meet(std::shared_ptr<transport::Connection> connection)
    {
        connection_ = std::move(connection);
        connection_->start({.packet = [this](protocol::Packet&& packet) { on_packet(packet); },
                            .closed =
                                [self = shared_from_this()](const Error&) {
                                    if (std::exchange(self->served_, false)) {
                                        --self->goal_.served;
                                        ++self->goal_.lost;
                                    }
                                    self->connection_.reset();
                                    self->retry();
                                }});
        const protocol::Hello hello{.name = name_, .kind = "guest", .epoch = 1, .pid = 1};
        connection_->send(protocol::make_packet(PacketType::hello, to_text(to_json(hello))));
    }

    void on_packet(const protocol::Packet& packet)
    {
        if (packet.type == PacketType::hello) {
            connection_->open({});
            const Json registration{{"id", 1},
                                    {"epoch", 1},
                                    {"output", "exceptions"},
                                    {"receiver", name_},
                                    {"options", {{"transfer", "stream"}}}};
            connection_->send(protocol::make_packet(PacketType::register_receiver, to_text(registration), 1));
        } else if (packet.type == PacketType::confirmation && !served_
                   && !parse_json(packet.header_text()).contains("error")) {
            served_ = true;
            ++goal_.served;
            backoff_.reset();
        }
    }

    void retry()
    {
        if (goal_.over)
            return;
        timer_.expires_after(backoff_.next());
        timer_.async_wait([self = shared_from_this()](std::error_code error) {
            if (!error)
                self->dial();
        });
    }

    asio::io_context& context_;
    Goal& goal_;
    std::string name_;
    Backoff backoff_;
    asio::steady_timer timer_;
    std::shared_ptr<transport::Connection> connection_;
    bool served_ = false;
};

class Silent : public std::enable_shared_from_this<Silent> {
public:
    Silent(asio::io_context& context, asio::ip::tcp::endpoint to) : socket_(context), to_(std::move(to)) {}

    void come()
    {
        socket_ = asio::ip::tcp::socket(socket_.get_executor());
        socket_.async_connect(to_, [self = shared_from_this()](std::error_code) {
            self->socket_.async_read_some(asio::buffer(self->byte_),
                                          [self](std::error_code, std::size_t) { self->come(); });
        });
    }

private:
    asio::ip::tcp::socket socket_;
    asio::ip::tcp::endpoint to_;
    std::array<char, 64> byte_{};
};

}  // namespace crowd

class Crowd::Impl {
public:
    Impl(const std::string& address, const std::filesystem::path& key)
    {
        goal_.address = transport::parse_address(address);
        goal_.security.keys = std::make_shared<transport::KeyRing>(key);
        thread_ = std::thread([this] { context_.run(); });
    }
    ~Impl()
    {
        asio::post(context_, [this] { goal_.over = true; });
        context_.stop();
        thread_.join();
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

    void come(int peers)
    {
        asio::post(context_, [this, peers] {
            for (int i = 0; i < peers; ++i)
                guests_
                    .emplace_back(std::make_shared<crowd::Guest>(context_, goal_, static_cast<int>(guests_.size()) + 1))
                    ->dial();
        });
    }
    void lose_connections()
    {
        asio::post(context_, [this] {
            for (const auto& guest : guests_)
                guest->lose();
        });
    }
    void come_silently(int peers)
    {
        asio::post(context_, [this, peers] {
            const asio::ip::tcp::endpoint to(asio::ip::make_address(goal_.address.host), goal_.address.port);
            for (int i = 0; i < peers; ++i)
                std::make_shared<crowd::Silent>(context_, to)->come();
        });
    }
    [[nodiscard]] int served() const { return goal_.served; }
    [[nodiscard]] int lost() const { return goal_.lost; }

private:
    crowd::Goal goal_;
    asio::io_context context_;
    asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
    std::vector<std::shared_ptr<crowd::Guest>> guests_;
    std::thread thread_;
};

Crowd::Crowd(const std::string& address, const std::filesystem::path& key) : impl_(std::make_unique<Impl>(address, key))
{
}
Crowd::~Crowd() = default;
void Crowd::come(int peers) { impl_->come(peers); }
int Crowd::served() const { return impl_->served(); }
int Crowd::lost() const { return impl_->lost(); }
void Crowd::lose_connections() { impl_->lose_connections(); }
void Crowd::come_silently(int peers) { impl_->come_silently(peers); }

}  // namespace hive::test
