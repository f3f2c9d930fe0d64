// What the network between two ends may see and change: nothing that matters.
#include "transport_world.hpp"

#include <asio/ip/tcp.hpp>
#include <asio/write.hpp>

#include <array>

using namespace world;

namespace {

using asio::ip::tcp;

/// Passes bytes on between two sockets, remembers them, and changes one if it is told to.
class Middleman {
public:
    Middleman(Loop& loop, const Address& to)
        : context_(loop.context), acceptor_(loop.context, tcp::endpoint(asio::ip::address_v4::loopback(), 0)), to_(to)
    {
        acceptor_.async_accept([this](std::error_code error, tcp::socket socket) {
            REQUIRE(!error);
            near_ = std::move(socket);
            far_.connect(tcp::endpoint(asio::ip::make_address(to_.host), to_.port));
            pass(near_, far_, there_);
            pass(far_, near_, back_);
        });
    }
    [[nodiscard]] Address address() const
    {
        return {Address::Scheme::tcp, "127.0.0.1", acceptor_.local_endpoint().port()};
    }
    /// The next bytes towards the listener come damaged.
    void damage() { damage_ = true; }
    [[nodiscard]] const std::string& seen() const { return seen_; }

private:
    using Buffer = std::array<char, 16 * 1024>;
    void pass(tcp::socket& from, tcp::socket& to, Buffer& buffer)
    {
        from.async_read_some(asio::buffer(buffer), [&, this](std::error_code error, std::size_t bytes) {
            std::error_code ignored;
            if (error)
                return static_cast<void>(to.close(ignored));
            seen_.append(buffer.data(), bytes);
            if (damage_ && &from == &near_)
                buffer[bytes / 2] ^= 1;
            asio::write(to, asio::buffer(buffer, bytes), ignored);
            pass(from, to, buffer);
        });
    }

    asio::io_context& context_;
    tcp::acceptor acceptor_;
    const Address to_;
    tcp::socket near_{context_}, far_{context_};
    Buffer there_, back_;
    std::string seen_;
    bool damage_ = false;
};

struct Watched {
    Loop loop;
    Folder folder;
    End dialing, listening;
    std::unique_ptr<hive::transport::Listener> listener;
    std::unique_ptr<Middleman> middleman;

    explicit Watched(const hive::transport::Security& security)
    {
        listener = hive::transport::listen(
            loop.context, Tcp::address(folder), [this](auto connection) { listening.start(std::move(connection)); },
            patient, security);
        middleman = std::make_unique<Middleman>(loop, listener->address());
        hive::transport::dial(
            loop.context, middleman->address(), 5s,
            [this](auto connection) {
                REQUIRE_FALSE(error_of(connection));
                dialing.start(value_or_none(std::move(connection)));
                dialing.send(PacketType::hello, "{}");
            },
            patient, security);
        REQUIRE(loop.until([this] { return listening.has(1); }));
    }
};

const std::string secret = "what only the two ends may know";

}  // namespace

TEST_CASE("tampering: what travels under a key cannot be read on the way, unlike plain packets")
{
    Folder folder;
    for (const auto& security : {keyed(folder), hive::transport::Security{}}) {
        Watched watched(security);
        watched.dialing.send(PacketType::event, "{}", secret);
        REQUIRE(watched.loop.until([&] { return watched.listening.has(2); }));
        CHECK((watched.middleman->seen().find(secret) == std::string::npos) == (security.keys != nullptr));
    }
}

TEST_CASE("tampering: one bit that was changed ends the connection, and no damaged packet arrives")
{
    Folder folder;
    Watched watched(keyed(folder));
    for (int i = 0; i < 5; ++i)
        watched.dialing.send(PacketType::event, "{}", std::string(100'000, 'x'));
    REQUIRE(watched.loop.until([&] { return watched.listening.has(6); }));
    watched.middleman->damage();
    watched.dialing.send(PacketType::event, "{}", std::string(100'000, 'y'));
    REQUIRE(watched.loop.until([&] { return watched.listening.closed == 1 && watched.dialing.closed == 1; }));
    CHECK(watched.listening.packets.size() == 6);
    CHECK(watched.listening.code == Errc::connection_lost);
    MESSAGE(watched.listening.text);
}
