// A hostile peer that shares memory (faults.md, row 20 in spirit): it loses its connection, and nothing of it is ever
// mapped that could hurt.
#include "transport_world.hpp"

#include <hive/protocol/messages.hpp>

#include <csignal>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace world;
using hive::protocol::Reference;
using hive::protocol::Segment;

namespace {

constexpr std::size_t slot_size = 64 * 1024;
constexpr int all_seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;

/// Shared memory as a peer would make it, with some of the seals.
int memory(std::size_t size, int seals)
{
    const int descriptor = ::memfd_create("hostile", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    REQUIRE(descriptor >= 0);
    REQUIRE(::ftruncate(descriptor, static_cast<off_t>(size)) == 0);
    REQUIRE(::fcntl(descriptor, F_ADD_SEALS, seals) == 0);
    return descriptor;
}

std::string text_of(const hive::Body& body) { return {reinterpret_cast<const char*>(body.data()), body.size()}; }

struct HostilePeer : RawPair {
    HostilePeer() : RawPair(Unix::address, patient)
    {
        raw = nullptr;
        raw = hive::transport::make_descriptor_stream(
            hive::transport::adopt_socket(loop.context, AF_UNIX, connect_raw(listener->address())), "hostile");
        end = {};
        REQUIRE(loop.until([this] { return end.connection != nullptr; }));
        REQUIRE(write(hello()));
        REQUIRE(loop.until([this] { return end.has(1); }));
    }
    void offer(const Segment& segment, int descriptor)
    {
        const auto packet = encoded(PacketType::segment, hive::to_text(to_json(segment)));
        const asio::const_buffer bytes(packet.data(), packet.size());
        bool done = false;
        raw->write_with(descriptor, {&bytes, 1}, [&](std::error_code, std::size_t) { done = true; });
        REQUIRE(loop.until([&] { return done; }));
        ::close(descriptor);
    }
    void refer(const Reference& reference) { write(encoded(PacketType::reference, "{}", text_of(to_body(reference)))); }
};

Errc verdict(HostilePeer& peer)
{
    REQUIRE(peer.until_closed(2s));
    return peer.end.code;
}

}  // namespace

TEST_CASE("hostile shared memory: without every seal it is refused")
{
    for (const int missing : {F_SEAL_SHRINK, F_SEAL_GROW, F_SEAL_FUTURE_WRITE, F_SEAL_SEAL, all_seals}) {
        CAPTURE(missing);
        HostilePeer peer;
        peer.offer({0, 8, slot_size}, memory(8 * slot_size, all_seals & ~missing));
        CHECK(verdict(peer) == Errc::malformed);
    }
}

TEST_CASE("hostile shared memory: what the seals are for: a reader of unsealed memory that is cut short dies of SIGBUS")
{
    const int descriptor = memory(slot_size, 0);
    const pid_t reader = ::fork();
    if (reader == 0) {
        ::signal(SIGBUS, SIG_DFL);
        const void* const mapped = ::mmap(nullptr, slot_size, PROT_READ, MAP_SHARED, descriptor, 0);
        const bool cut = ::ftruncate(descriptor, 0) == 0;
        ::_exit(cut ? *static_cast<const volatile char*>(mapped) : 1);
    }
    int status = 0;
    REQUIRE(::waitpid(reader, &status, 0) == reader);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGBUS);
    ::close(descriptor);
}

TEST_CASE("hostile shared memory: smaller than it says, without a descriptor, or no memory at all")
{
    HostilePeer small;
    small.offer({0, 8, slot_size}, memory(7 * slot_size, all_seals));
    CHECK(verdict(small) == Errc::malformed);
    HostilePeer none;
    none.write(encoded(PacketType::segment, hive::to_text(to_json(Segment{0, 8, slot_size}))));
    CHECK(verdict(none) == Errc::malformed);
    HostilePeer file;
    file.offer({0, 1, 4096}, ::open("/dev/zero", O_RDWR | O_CLOEXEC));
    CHECK(verdict(file) == Errc::malformed);
    HostilePeer twice;
    twice.offer({0, 8, slot_size}, memory(8 * slot_size, all_seals));
    twice.offer({0, 8, slot_size}, memory(8 * slot_size, all_seals));
    CHECK(verdict(twice) == Errc::malformed);
}

TEST_CASE("hostile shared memory: references outside their slot or to nothing")
{
    for (const auto& reference :
         {Reference{{1, 0, 1}, 0, 10}, Reference{{0, 8, 1}, 0, 10}, Reference{{0, 7, 1}, 1, slot_size},
          Reference{{0, 0, 1}, slot_size + 1, 0}, Reference{{0, 0, 1}, ~std::uint64_t{0}, 2},
          Reference{{0, 0, 1}, 2, ~std::uint64_t{0}}}) {
        HostilePeer peer;
        peer.offer({0, 8, slot_size}, memory(8 * slot_size, all_seals));
        peer.refer(reference);
        CHECK(verdict(peer) == Errc::malformed);
        CHECK(peer.end.packets.size() == 1);  // the hello
    }
    HostilePeer short_reference;
    short_reference.write(encoded(PacketType::reference, "{}", "short"));
    CHECK(verdict(short_reference) == Errc::malformed);
}

TEST_CASE("hostile shared memory: slots that are no whole pages, and a body over the limit")
{
    HostilePeer odd;
    odd.offer({.id = 0, .slots = 4, .slot_size = 6000}, memory(24000, all_seals));
    CHECK(verdict(odd) == Errc::malformed);

    HostilePeer large;
    constexpr std::size_t size = 128u << 20;  // nothing of it is ever touched
    large.offer({.id = 0, .slots = 1, .slot_size = size}, memory(size, all_seals));
    large.refer({{0, 0, 1}, 0, size});
    CHECK(verdict(large) == Errc::too_large);
}

TEST_CASE("hostile shared memory: what was mapped can neither shrink nor grow under its reader")
{
    HostilePeer peer;
    const int descriptor = memory(8 * slot_size, all_seals);
    const int kept = ::dup(descriptor);
    peer.offer({0, 8, slot_size}, descriptor);
    peer.refer({{0, 7, 1}, 0, slot_size});
    REQUIRE(peer.loop.until([&] { return peer.end.has(2); }));
    CHECK(::ftruncate(kept, 0) != 0);
    CHECK(peer.end.packets[1].body.data()[slot_size - 1] == 0);  // no SIGBUS
    CHECK(peer.end.packets[1].body.foreign());
    ::close(kept);
}

TEST_CASE("hostile shared memory: slots given back that were never lent, or not whole ones")
{
    HostilePeer peer;
    peer.write(encoded(PacketType::release, "", std::string(32, '\1')));
    peer.write(encoded(PacketType::get, "{}"));
    REQUIRE(peer.loop.until([&] { return peer.end.has(2); }));  // ignored: it may be late
    peer.end.connection->share(std::make_shared<hive::transport::Pool>());
    peer.write(encoded(PacketType::release, "", std::string(15, '\1')));
    CHECK(verdict(peer) == Errc::malformed);
    HostilePeer that_maps_nothing;
    that_maps_nothing.write(encoded(PacketType::release, "", std::string(15, '\1')));
    CHECK(verdict(that_maps_nothing) == Errc::malformed);
}

TEST_CASE("hostile shared memory: descriptors that nobody asked for end the connection and stay nowhere")
{
    HostilePeer peer;
    const auto open_descriptors = [] {
        return std::distance(std::filesystem::directory_iterator("/proc/self/fd"),
                             std::filesystem::directory_iterator());
    };
    const auto before = open_descriptors();
    for (int i = 0; i < 20 && peer.end.closed == 0; ++i) {
        const auto packet = encoded(PacketType::get, "{}");
        const asio::const_buffer bytes(packet.data(), packet.size());
        bool done = false;
        peer.raw->write_with(0, {&bytes, 1}, [&](std::error_code, std::size_t) { done = true; });
        REQUIRE(peer.loop.until([&] { return done; }));
        peer.loop.run_for(5ms);
    }
    CHECK(peer.until_closed(2s));
    CHECK(open_descriptors() <= before);
}

TEST_CASE_TEMPLATE("hostile shared memory: on a connection that cannot share there is no such thing", Place, Tcp,
                   InProcess)
{
    RawPair pair(Place::address, patient);
    pair.write(hello());
    REQUIRE(pair.loop.until([&] { return pair.end.has(1); }));
    pair.write(encoded(PacketType::segment, hive::to_text(to_json(Segment{0, 8, slot_size}))));
    CHECK(pair.until_closed(2s));
    CHECK(pair.end.code == Errc::malformed);
}
