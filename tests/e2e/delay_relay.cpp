// A poll() loop over the connections, with queues of data in flight.
#include "delay_relay.hpp"

#include "eventually.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <future>
#include <list>
#include <thread>
#include <vector>

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace hive::test {
namespace {

int open_socket()
{
    const int descriptor = require_descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), "relay: socket");
    const int on = 1;
    ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return descriptor;
}

}  // namespace

/// One direction of a connection. Blocking writes: all peers here keep reading.
struct RelayedWay {
    struct Piece {
        Clock::time_point due;
        std::vector<char> bytes;  ///< empty: the end
    };
    int from, to;
    std::deque<Piece> under_way{};
    bool ended = false;

    void read(Clock::time_point due)
    {
        std::vector<char> bytes(64 * 1024);
        const auto size = ::read(from, bytes.data(), bytes.size());
        bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
        ended = bytes.empty();
        under_way.push_back({due, std::move(bytes)});
    }
    void write(Clock::time_point now)
    {
        for (; !under_way.empty() && under_way.front().due <= now; under_way.pop_front()) {
            const auto& bytes = under_way.front().bytes;
            if (bytes.empty())
                ::shutdown(to, SHUT_WR);
            else if (::send(to, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0)
                ::shutdown(from, SHUT_RD);
        }
    }
};

class DelayRelay::Impl {
public:
    Impl(const std::string& network_namespace, const NetworkAddress& at, const NetworkAddress& to,
         Clock::duration one_way)
        : to_(socket_address(to)), one_way_(one_way)
    {
        std::promise<void> begun;
        auto ready = begun.get_future();
        thread_ = std::thread([this, network_namespace, at, &begun] {
            try {
                listen(network_namespace, at);
                begun.set_value();
            } catch (...) {
                return begun.set_exception(std::current_exception());
            }
            run();
        });
        try {
            ready.get();
        } catch (...) {
            thread_.join();
            throw;
        }
    }
    ~Impl()
    {
        stopping_ = true;
        thread_.join();
        for (const auto& way : ways_)
            ::close(way.from);
        ::close(listening_);
    }
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;

private:
    void listen(const std::string& network_namespace, const NetworkAddress& at)
    {
        enter_network(network_namespace);
        listening_ = open_socket();
        const auto address = socket_address(at);
        require_descriptor(::bind(listening_, reinterpret_cast<const sockaddr*>(&address), sizeof address),
                           "relay: bind");
        require_descriptor(::listen(listening_, 16), "relay: listen");
    }
    void run()
    {
        while (!stopping_) {
            std::vector<pollfd> watched{{listening_, POLLIN, 0}};
            for (const auto& way : ways_)
                watched.push_back({way.ended ? -1 : way.from, POLLIN, 0});
            ::poll(watched.data(), watched.size(), 1);
            const auto now = Clock::now();
            std::size_t place = 1;
            for (auto& way : ways_) {
                if (watched[place++].revents != 0)
                    way.read(now + one_way_);
                way.write(now);
            }
            if (watched[0].revents != 0)
                accept();
        }
    }
    void accept()
    {
        const int near = ::accept4(listening_, nullptr, nullptr, SOCK_CLOEXEC), far = open_socket();
        if (near < 0 || ::connect(far, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) != 0) {
            ::close(near);
            ::close(far);
            return;
        }
        ways_.push_back({near, far});
        ways_.push_back({far, near});
    }

    const sockaddr_in to_;
    const Clock::duration one_way_;
    std::thread thread_;
    std::atomic<bool> stopping_ = false;
    int listening_ = -1;
    std::list<RelayedWay> ways_;
};

DelayRelay::DelayRelay(const std::string& network_namespace, const NetworkAddress& at, const NetworkAddress& to,
                       std::chrono::milliseconds one_way)
    : impl_(std::make_unique<Impl>(network_namespace, at, to, one_way))
{
}
DelayRelay::~DelayRelay() = default;

}  // namespace hive::test
