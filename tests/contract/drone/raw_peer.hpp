// A peer written from SPEC.md alone, on plain POSIX sockets: it shares no code with libhive, so it can be wrong on
// purpose.
#pragma once

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace raw {

using Json = nlohmann::json;
using Milliseconds = std::chrono::milliseconds;

/// Section 2.
enum Type : int {
    hello = 1,
    ping = 2,
    pong = 3,
    register_ = 10,
    deregister = 11,
    request = 12,
    event = 20,
    notification = 21,
    exception = 22,
    end = 24,
    connect = 30,
    disconnect = 31,
    set = 32,
    get = 33,
    describe = 34,
    status = 35,
    halt = 36,
    resume = 37,
    stop = 38,
    put = 39,
    forget = 40,
    confirmation = 50
};

struct Packet {
    int type = 0;
    int channel = 0;
    std::string header, body;
    [[nodiscard]] Json json() const { return Json::parse(header); }
};

/// The 16 bytes of section 2, whatever the numbers say.
std::string prefix(int type, int channel, std::uint32_t header_size, std::uint32_t body_size,
                   const std::string& magic = "HIVE", int version = 1);
std::string packet(int type, int channel, const std::string& header, const std::string& body = {});
/// A hello as this peer says it.
std::string hello_packet(const std::string& name = "raw", const std::string& kind = "application");

/// One end of a stream. Every wait has an end; while it waits for packets it keeps section 4.3: it answers pings and
/// sends its own.
class Peer {
public:
    explicit Peer(int descriptor) : descriptor_(descriptor) {}
    /// Connects to a unix socket; throws std::runtime_error.
    static Peer dial(const std::filesystem::path& socket);
    /// Connects and exchanges hellos.
    static Peer meet(const std::filesystem::path& socket, const std::string& name = "raw");
    ~Peer();
    Peer(Peer&& other) noexcept;
    Peer& operator=(Peer&& other) noexcept;

    /// Writes all of it, or as much as the peer takes within `timeout`. False when the peer has closed or does not
    /// read.
    bool send(const std::string& bytes, Milliseconds timeout = Milliseconds(5000));
    /// The next packet but ping and pong; nothing when the time is over or the stream has ended.
    std::optional<Packet> next(Milliseconds timeout = Milliseconds(5000));
    /// The next packet of this type; others are dropped, but exceptions, events and notifications with `seen`.
    std::optional<Packet> next_of(int type, Milliseconds timeout = Milliseconds(5000),
                                  const std::function<void(const Packet&)>& seen = {});
    /// Sends a request (with an id) and returns the confirmation's JSON; null when none came.
    Json ask(int type, Json fields = Json::object(), int channel = 0, const std::string& body = {},
             Milliseconds timeout = Milliseconds(10'000));
    /// Does the other end close within the time? What it sends meanwhile is dropped.
    bool closed_within(Milliseconds timeout);
    [[nodiscard]] bool ended() const noexcept { return ended_; }
    /// Sends nothing by itself, not even pongs.
    void silent(bool yes) noexcept { silent_ = yes; }
    [[nodiscard]] Packet first() const { return first_; }  ///< the other's hello
    void close();
    [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

private:
    std::optional<Packet> take();
    bool fill(std::chrono::steady_clock::time_point until);

    int descriptor_ = -1;
    std::string buffer_;
    Packet first_;
    bool ended_ = false, silent_ = false;
    std::int64_t last_id_ = 0;
    std::chrono::steady_clock::time_point sent_{};
};

/// A socket that listens under a drone's name, for peers that are no drone.
class Listener {
public:
    explicit Listener(const std::filesystem::path& socket);
    ~Listener();
    Listener(const Listener&) = delete;
    Listener& operator=(const Listener&) = delete;
    /// The next peer, before any hello.
    std::optional<Peer> accept(Milliseconds timeout = Milliseconds(5000));

private:
    std::filesystem::path socket_;
    int descriptor_ = -1;
};

/// The error code of a confirmation, empty when it was a success, "no answer" when there was none.
std::string error_of(const Json& answer);
/// The text of its error.
std::string text_of(const Json& answer);

}  // namespace raw
