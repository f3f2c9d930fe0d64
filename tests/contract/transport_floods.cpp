// Peers with the key that keep the network side busy: what they send costs nobody else's turn, and no memory.
#include "transport_world.hpp"

#include "tls_session.hpp"

#include <asio/post.hpp>

#include <algorithm>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace world;
using hive::transport::KeyTalk;
using hive::transport::SocketTurn;
using hive::transport::TlsEnd;

namespace {

/// A listening end, and a peer that is OpenSSL itself in the hands of the test.
class Flood {
public:
    Flood()
    {
        listener_ = hive::transport::listen(
            loop.context, Tls::address(folder_),
            [this](auto connection) {
                end.start(std::move(connection));
                end.send(PacketType::hello, "{}");
            },
            patient, keyed(folder_));
        turn_.socket = connect_raw(listener_->address());
        session_ = hive::transport::make_tls_session(TlsEnd::dialer, turn_, talk_, outgoing_);
        REQUIRE(loop.until([&] {
            turn_.begin();
            const bool done = ::SSL_do_handshake(session_.get()) == 1;
            send();
            return done;
        }));
        write(hello());
        REQUIRE(loop.until([&] { return end.has(1); }));
    }
    Flood(const Flood&) = delete;
    Flood& operator=(const Flood&) = delete;
    ~Flood() { ::close(turn_.socket); }

    void change_keys()
    {
        REQUIRE(::SSL_key_update(session_.get(), SSL_KEY_UPDATE_REQUESTED) == 1);
        ::SSL_do_handshake(session_.get());
        send();
    }
    void write(const std::string& bytes)
    {
        std::size_t written = 0;
        REQUIRE(::SSL_write_ex(session_.get(), bytes.data(), bytes.size(), &written) == 1);
        send();
    }
    /// Does the operating system take more at once?
    [[nodiscard]] bool has_room() const
    {
        pollfd row{turn_.socket, POLLOUT, 0};
        return ::poll(&row, 1, 0) == 1;
    }

    Loop loop;
    End end;

private:
    void send()
    {
        for (std::size_t sent = 0; sent < outgoing_.size();) {
            const auto bytes = ::send(turn_.socket, outgoing_.data() + sent, outgoing_.size() - sent, MSG_NOSIGNAL);
            if (bytes < 0)
                break;  // the other end has closed
            sent += static_cast<std::size_t>(bytes);
        }
        outgoing_.clear();
    }

    Folder folder_;
    std::unique_ptr<hive::transport::Listener> listener_;
    std::vector<unsigned char> outgoing_;
    SocketTurn turn_;
    KeyTalk talk_{.keys = {keyed(folder_).keys->own().front()}};
    hive::transport::SslPtr session_{nullptr, ::SSL_free};
};

}  // namespace

TEST_CASE("flood: a peer may change the keys of its connection now and then, and is closed when it does nothing else")
{
    Flood flood;
    for (int i = 0; i < 10; ++i)
        flood.change_keys();
    flood.write(encoded(PacketType::status, "{}"));
    REQUIRE(flood.loop.until([&] { return flood.end.has(2); }));
    for (int i = 0; i < 1000; ++i)
        flood.change_keys();
    CHECK(flood.loop.until([&] { return flood.end.closed == 1; }));
    CHECK(flood.end.text.find("too many key updates") != std::string::npos);
}

TEST_CASE("flood: a body in records of one byte leaves the others their turns")
{
    Flood flood;
    flood.write(prefix(PacketType::put, 2, 60'000'000) + "{}");
    std::size_t bytes = 0;
    for (const auto end = std::chrono::steady_clock::now() + 5s;
         flood.has_room() && std::chrono::steady_clock::now() < end; ++bytes)
        flood.write("x");
    auto last = std::chrono::steady_clock::now();
    std::chrono::steady_clock::duration longest{};
    bool over = false;
    const std::function<void()> look = [&] {
        const auto now = std::chrono::steady_clock::now();
        longest = std::max(longest, now - last);
        last = now;
        if (!over)
            asio::post(flood.loop.context, look);
    };
    look();
    flood.loop.run_for(1s);
    over = true;
    flood.loop.run_for(1ms);
    MESSAGE(bytes, " records; nobody waited longer than ", longest / 1us, " us");
    CHECK(bytes > 50'000);
    CHECK(longest < (sanitized ? 400ms : 40ms));  // all of them take longer
    CHECK(flood.end.closed == 0);
}

TEST_CASE_TEMPLATE("flood: what may not be sent is refused by its prefix, and what has no body is read without", Place,
                   Unix, Tcp)
{
    RawPair pair(Place::address, patient);
    pair.end.wants = [](PacketType type, std::uint16_t) {
        if (type == PacketType::stop)
            throw hive::Error(Errc::not_permitted, "not you");
        return type != PacketType::event;
    };
    REQUIRE(pair.write(hello()));
    REQUIRE(pair.write(encoded(PacketType::status, "{}", std::string(300'000, 'x'))
                       + encoded(PacketType::event, "{}", std::string(300'000, 'x'))
                       + encoded(PacketType::put, "{}", std::string(300'000, 'x'))));
    REQUIRE(pair.loop.until([&] { return pair.end.has(4); }));
    const auto& packets = pair.end.packets;
    CHECK(packets[1].type == PacketType::status);
    CHECK(packets[1].body.empty());
    CHECK(packets[2].body.empty());
    CHECK(packets[3].body.size() == 300'000);
    REQUIRE(pair.write(prefix(PacketType::stop, 2, 60'000'000)));
    CHECK(pair.until_closed());
    CHECK(pair.end.code == Errc::not_permitted);
}
