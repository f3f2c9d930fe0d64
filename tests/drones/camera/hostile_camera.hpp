// A camera of which a test decides each byte: a server in this process, with a thread for each connection.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace hostile {

/// One connection.
class Client {
public:
    explicit Client(int socket, std::atomic<std::size_t>& sent) : socket_(socket), sent_(sent) {}

    /// The next request, with its empty line; empty if the client has left.
    std::string request()
    {
        std::string text;
        for (char byte = 0; !text.ends_with("\r\n\r\n"); text += byte)
            if (::recv(socket_, &byte, 1, 0) != 1)
                return "";
        return text;
    }
    /// False if the client has left.
    bool send(std::string_view bytes)
    {
        while (!bytes.empty()) {
            const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
            if (sent <= 0)
                return false;
            sent_ += static_cast<std::size_t>(sent);
            bytes.remove_prefix(static_cast<std::size_t>(sent));
        }
        return true;
    }
    /// Repeats the same bytes until this many were sent or the client has disconnected.
    void flood(const std::string& bytes, std::size_t most)
    {
        for (std::size_t sent = 0; sent < most && send(bytes); sent += bytes.size()) {
        }
    }

private:
    int socket_;
    std::atomic<std::size_t>& sent_;
};

class Camera {
public:
    /// @param answer  is called with each request, until the client leaves or the answer is false
    using Answer = std::function<bool(Client&, const std::string& request)>;

    explicit Camera(Answer answer)
        : answer_(std::move(answer)), listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0))
    {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const any = reinterpret_cast<sockaddr*>(&address);
        if (::bind(listener_, any, size) != 0 || ::listen(listener_, 64) != 0
            || ::getsockname(listener_, any, &size) != 0)
            throw std::runtime_error("cannot listen");
        port_ = ntohs(address.sin_port);
        acceptor_ = std::jthread([this] { accept_all(); });
    }
    ~Camera()
    {
        ::shutdown(listener_, SHUT_RDWR);
        acceptor_.join();
        for (const int socket : sockets_)
            ::shutdown(socket, SHUT_RDWR);
        threads_.clear();
        for (const int socket : sockets_)
            ::close(socket);
        ::close(listener_);
    }
    Camera(const Camera&) = delete;
    Camera& operator=(const Camera&) = delete;

    [[nodiscard]] std::string url(const std::string& scheme = "http", const std::string& path = "/video") const
    {
        return scheme + "://127.0.0.1:" + std::to_string(port_) + path;
    }
    [[nodiscard]] std::size_t connections() const { return connections_; }
    [[nodiscard]] std::size_t sent() const { return sent_; }
    /// All requests so far.
    [[nodiscard]] std::string asked() const
    {
        const std::lock_guard lock(mutex_);
        return asked_;
    }

private:
    void accept_all()
    {
        for (int socket; (socket = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC)) >= 0;) {
            ++connections_;
            sockets_.push_back(socket);
            threads_.emplace_back([this, socket] { serve(socket); });
        }
    }
    void serve(int socket)
    {
        Client client(socket, sent_);
        for (std::string request; !(request = client.request()).empty();) {
            {
                const std::lock_guard lock(mutex_);
                asked_ += request;
            }
            if (!answer_(client, request))
                break;
        }
        ::shutdown(socket, SHUT_RDWR);
    }

    Answer answer_;
    int listener_, port_ = 0;
    std::atomic<std::size_t> connections_ = 0, sent_ = 0;
    mutable std::mutex mutex_;
    std::string asked_;
    std::vector<int> sockets_;
    std::vector<std::jthread> threads_;
    std::jthread acceptor_;
};

}  // namespace hostile
