// Two ends that exchange images through shared memory, each of which may be another process.
#pragma once

#include <hive/transport/transport.hpp>

#include <asio/io_context.hpp>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace memory {

using hive::Body;
using hive::transport::Connection;
using hive::transport::Pool;

inline constexpr std::size_t image_size = 256 * 1024;

/// Every byte of image `number` is the same, so that any other byte shows.
bool intact(const Body& body);

/// Sends images through a pool, at most four that were not asked for yet.
class Producer {
public:
    Producer(std::shared_ptr<Connection> connection, std::shared_ptr<Pool> pool);
    void start();
    [[nodiscard]] bool closed() const noexcept { return closed_; }
    [[nodiscard]] int asked() const noexcept { return asked_; }
    [[nodiscard]] int fallbacks() const noexcept { return fallbacks_; }

private:
    void produce();

    std::shared_ptr<Connection> connection_;
    std::shared_ptr<Pool> pool_;
    int sent_ = 0, asked_ = 0, fallbacks_ = 0;
    bool closed_ = false;
};

/// Takes images, keeps the last few, asks for the next.
class Receiver {
public:
    explicit Receiver(std::shared_ptr<Connection> connection) : connection_(std::move(connection)) {}
    void start();
    [[nodiscard]] bool closed() const noexcept { return closed_; }
    [[nodiscard]] int received() const noexcept { return received_; }
    [[nodiscard]] int broken() const noexcept { return broken_; }
    [[nodiscard]] std::deque<Body> take_kept() { return std::move(kept_); }

private:
    void take(const Body& body);

    std::shared_ptr<Connection> connection_;
    std::deque<Body> kept_;
    int received_ = 0, broken_ = 0;
    bool closed_ = false;
};

/// The main of the other process: dials the path and is a "producer" or a "receiver" until it is killed or cut off.
int run_peer(const std::string& role, const std::string& path);

}  // namespace memory
