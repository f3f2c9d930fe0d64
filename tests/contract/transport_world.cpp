// The world of the transport tests.
#include "transport_world.hpp"

#include <cstdlib>
#include <fstream>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace world {

Folder::Folder()
{
    std::string name = (std::filesystem::temp_directory_path() / "hive-transport-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    at_ = name;
}

Folder::~Folder()
{
    std::error_code ignored;
    std::filesystem::remove_all(at_, ignored);
}

bool Loop::until(const std::function<bool()>& condition, std::chrono::milliseconds limit)
{
    const auto end = std::chrono::steady_clock::now() + limit;
    while (!condition()) {
        if (std::chrono::steady_clock::now() >= end)
            return false;
        if (context.stopped())
            context.restart();
        context.run_one_for(5ms);
    }
    return true;
}

void Loop::run_for(std::chrono::milliseconds time)
{
    until([] { return false; }, time);
}

hive::transport::Security keyed(const Folder& folder, const std::string& name)
{
    const auto file = folder.path(name);
    if (!std::filesystem::exists(file))
        hive::write_key_file(file, {hive::new_swarm_key(1)}, hive::KeyFileMode::fresh);
    return {.keys = std::make_shared<hive::transport::KeyRing>(file)};
}

hive::transport::Security security_of(Address (*address)(const Folder&), const Folder& folder)
{
    return address == Tls::address ? keyed(folder) : hive::transport::Security{};
}

void End::start(std::shared_ptr<Connection> with)
{
    connection = std::move(with);
    connection->start({
        .packet =
            [this](Packet&& packet) {
                CHECK(closed == 0);
                packets.push_back(std::move(packet));
                if (packets.size() == 1 && opens)
                    connection->open({});
                if (on_packet)
                    on_packet(packets.back());
            },
        .closed =
            [this](const hive::Error& error) {
                ++closed;
                code = error.code();
                text = error.what();
            },
        .wants = [this](PacketType type, std::uint16_t channel) { return !wants || wants(type, channel); },
    });
}

void End::send(PacketType type, std::string header, hive::Body body, Connection::Written written)
{
    connection->send(hive::protocol::make_packet(type, std::move(header), 0, std::move(body)), std::move(written));
}

Pair::Pair(Address (*address)(const Folder&), const Timing& timing, bool listening_opens)
{
    listening.opens = listening_opens;
    listener = hive::transport::listen(
        loop.context, address(folder),
        [this](auto connection) {
            listening.start(std::move(connection));
            listening.send(PacketType::hello, "{}");
        },
        timing, security_of(address, folder));
    hive::transport::dial(
        loop.context, listener->address(), 5s,
        [this](auto connection) {
            REQUIRE_FALSE(error_of(connection));
            dialing.start(value_or_none(std::move(connection)));
            dialing.send(PacketType::hello, "{}");
        },
        timing, security_of(address, folder));
    REQUIRE(loop.until([this] { return dialing.has(1) && listening.has(1); }));
    dialing.packets.clear();
    listening.packets.clear();
    dialing.opens = listening.opens = false;
}

RawPair::RawPair(Address (*address)(const Folder&), const Timing& timing)
{
    const auto place = address(folder);
    listener = hive::transport::listen(
        loop.context, place, [this](auto connection) { end.start(std::move(connection)); }, timing);
    const int family = place.scheme == Address::Scheme::tcp ? AF_INET : AF_UNIX;
    raw = hive::transport::make_socket_stream(
        hive::transport::adopt_socket(loop.context, family, connect_raw(listener->address())), "raw", true);
    REQUIRE(loop.until([this] { return end.connection != nullptr; }));
}

bool RawPair::write(const std::string& bytes)
{
    for (std::size_t begin = 0; begin < bytes.size();) {
        bool done = false;
        bool failed = false;
        const asio::const_buffer rest(bytes.data() + begin, bytes.size() - begin);
        raw->write_some({&rest, 1}, [&](std::error_code error, std::size_t count) {
            begin += count;
            failed = static_cast<bool>(error);
            done = true;
        });
        REQUIRE(loop.until([&] { return done; }));
        if (failed)
            return false;
    }
    return true;
}

bool RawPair::until_closed(std::chrono::milliseconds limit)
{
    return loop.until([this] { return end.closed > 0; }, limit);
}

std::string prefix(PacketType type, std::uint32_t header_size, std::uint32_t body_size)
{
    const auto bytes = hive::protocol::encode({type, 0, header_size, body_size});
    return {bytes.begin(), bytes.end()};
}

std::string encoded(PacketType type, const std::string& header, const std::string& body)
{
    return prefix(type, static_cast<std::uint32_t>(header.size()), static_cast<std::uint32_t>(body.size())) + header
           + body;
}

int connect_raw(const Address& address, std::uint32_t from)
{
    sockaddr_un unix_address{};
    unix_address.sun_family = AF_UNIX;
    address.host.copy(unix_address.sun_path, sizeof unix_address.sun_path - 1);
    sockaddr_in tcp_address{};
    tcp_address.sin_family = AF_INET;
    tcp_address.sin_port = htons(address.port);
    tcp_address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool tcp = address.scheme == Address::Scheme::tcp;
    const int descriptor = ::socket(tcp ? AF_INET : AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + from);
    if (tcp)
        REQUIRE(::bind(descriptor, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0);
    const int result = tcp ? ::connect(descriptor, reinterpret_cast<sockaddr*>(&tcp_address), sizeof tcp_address)
                           : ::connect(descriptor, reinterpret_cast<sockaddr*>(&unix_address), sizeof unix_address);
    REQUIRE(result == 0);
    return descriptor;
}

std::size_t resident_bytes()
{
    std::size_t size = 0;
    std::size_t resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace world
