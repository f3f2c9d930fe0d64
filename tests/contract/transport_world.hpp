// The small world of the transport tests: an event loop, places to meet, connection ends that remember, peers of raw
// bytes.
#pragma once

#include "socket_stream.hpp"

#include <hive/transport/transport.hpp>

#include <asio/io_context.hpp>
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace world {

using namespace std::chrono_literals;
using hive::Errc;
using hive::protocol::Packet;
using hive::protocol::PacketType;
using hive::transport::Address;
using hive::transport::Connection;
using hive::transport::Timing;

#ifdef HIVE_SANITIZED
inline constexpr bool sanitized = true;  // memory and time are the sanitizer's, not ours
#else
inline constexpr bool sanitized = false;
#endif

/// Times that no test reaches by itself, and times that tests wait for.
inline constexpr Timing patient{.heartbeat = 500ms, .silence = 20s, .first_packet = 20s, .stall = 20s};
inline constexpr Timing hasty{.heartbeat = 20ms, .silence = 150ms, .first_packet = 120ms, .stall = 120ms};

/// A folder of this test that goes with it.
class Folder {
public:
    Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder();
    [[nodiscard]] std::string path(const std::string& name) const { return (at_ / name).string(); }

private:
    std::filesystem::path at_;
};

struct Loop {
    asio::io_context context;
    /// Runs until the condition holds; false when it does not within the limit.
    bool until(const std::function<bool()>& condition, std::chrono::milliseconds limit = 60s);
    void run_for(std::chrono::milliseconds time);
};

// Where to meet; the types by which the contract is parameterised.
struct Unix {
    static Address address(const Folder& folder) { return {Address::Scheme::unix_socket, folder.path("place"), 0}; }
};
struct Tcp {
    static Address address(const Folder&) { return {Address::Scheme::tcp, "127.0.0.1", 0}; }
};
struct Tls {  ///< tcp, where both ends have a swarm key
    static Address address(const Folder&) { return {Address::Scheme::tcp, "127.0.0.1", 0}; }
};

/// The keys of a file in the folder, which is made when it is not there.
hive::transport::Security keyed(const Folder& folder, const std::string& name = "swarm.key");
/// For places where both ends have a key; nothing for the others.
hive::transport::Security security_of(Address (*address)(const Folder&), const Folder& folder);

/// One end of a connection and what happened to it.
struct End {
    std::shared_ptr<Connection> connection;
    std::vector<Packet> packets;
    int closed = 0;
    Errc code{};
    std::string text;
    bool opens = true;  ///< calls open() when the first packet comes
    std::function<void(const Packet&)> on_packet;
    std::function<bool(PacketType, std::uint16_t)> wants;

    void start(std::shared_ptr<Connection> with);
    [[nodiscard]] bool has(std::size_t count) const { return packets.size() >= count; }
    void send(PacketType type, std::string header = {}, hive::Body body = {}, Connection::Written written = {});
};

/// Two ends that have exchanged their hellos.
struct Pair {
    Loop loop;
    Folder folder;
    End dialing, listening;
    std::unique_ptr<hive::transport::Listener> listener;
    Pair(Address (*address)(const Folder&), const Timing& timing, bool listening_opens = true);
};

/// A connection whose peer is the test itself, byte by byte.
struct RawPair {
    Loop loop;
    Folder folder;
    std::unique_ptr<hive::transport::Stream> raw;
    End end;
    std::unique_ptr<hive::transport::Listener> listener;
    RawPair(Address (*address)(const Folder&), const Timing& timing);
    /// Writes, in as many pieces as it takes; false when the other end is gone.
    bool write(const std::string& bytes);
    bool until_closed(std::chrono::milliseconds limit = 60s);
};

std::string encoded(PacketType type, const std::string& header = {}, const std::string& body = {});
/// A prefix that promises what need not follow.
std::string prefix(PacketType type, std::uint32_t header_size, std::uint32_t body_size);
inline std::string hello() { return encoded(PacketType::hello, R"({"name":"a"})"); }

/// A blocking connect by the operating system alone.
/// @param from  the last number of a loopback address, 127.0.0.FROM
int connect_raw(const Address& address, std::uint32_t from = 1);
std::size_t resident_bytes();

}  // namespace world
