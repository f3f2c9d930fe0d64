// A hostile peer that shares memory (faults.md, row 20 in spirit): it loses its connection, and nothing of it is ever
// mapped that could hurt.
#include "packet_reader.hpp"
#include "transport_world.hpp"

#include <possible.hpp>

#include <hive/protocol/messages.hpp>

#include <csignal>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace world;
using hive::protocol::Reference;
using hive::protocol::Segment;

namespace {

constexpr std::size_t slot_size = 64 * 1024;
constexpr int all_seals = F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL;

/// Shared memory as a peer would make it, with some of the seals, and written up to somewhere: what comes behind are
/// holes.
int memory(std::size_t size, int seals, std::size_t written = 0)
{
    const int descriptor = ::memfd_create("hostile", MFD_CLOEXEC | MFD_ALLOW_SEALING);
    REQUIRE(descriptor >= 0);
    REQUIRE(::ftruncate(descriptor, static_cast<off_t>(size)) == 0);
    const std::string bytes(written, 'w');
    REQUIRE(::pwrite(descriptor, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(written));
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
    /// The next packet that comes to the test; its body.
    std::string answer(PacketType type)
    {
        PacketType came{};
        std::string body;
        hive::transport::PacketReader reader;
        const auto first = hello();  // which every reader expects
        reader.received(asio::buffer_copy(reader.space(), asio::buffer(first)));
        REQUIRE(reader.next());
        reader.open({});
        while (came != type) {
            bool done = false;
            raw->read_some(reader.space(), [&](std::error_code error, std::size_t bytes) {
                REQUIRE_FALSE(error);
                reader.received(bytes);
                done = true;
            });
            REQUIRE(loop.until([&] { return done; }));
            while (const auto packet = reader.next()) {
                came = packet->type;
                body = text_of(packet->body);
            }
        }
        return body;
    }
};

Errc verdict(HostilePeer& peer)
{
    REQUIRE(peer.until_closed());
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
    const int descriptor = memory(8 * slot_size, all_seals, 8 * slot_size);
    const int kept = ::dup(descriptor);
    peer.offer({0, 8, slot_size}, descriptor);
    peer.refer({{0, 7, 1}, 0, slot_size});
    REQUIRE(peer.loop.until([&] { return peer.end.has(2); }));
    CHECK(::ftruncate(kept, 0) != 0);
    CHECK(peer.end.packets[1].body.data()[slot_size - 1] == 'w');  // no SIGBUS
    CHECK(peer.end.packets[1].body.foreign());
    ::close(kept);
}

namespace {

constexpr std::size_t largest = 64u << 20;  // a body, by the usual limits

std::uint64_t backed_bytes(int descriptor)
{
    struct stat status {};
    REQUIRE(::fstat(descriptor, &status) == 0);
    return static_cast<std::uint64_t>(status.st_blocks) * 512;
}

}  // namespace

TEST_CASE("hostile shared memory: what was never written is refused, and nobody pays for its pages")
{
    for (const std::size_t written : {std::size_t{0}, largest - 4096}) {
        HostilePeer peer;
        const int descriptor = memory(2 * largest, all_seals, written), kept = ::dup(descriptor);
        peer.offer({0, 2, largest}, descriptor);
        peer.refer({{0, 0, 1}, 0, largest});
        CHECK(verdict(peer) == Errc::io);
        CHECK(backed_bytes(kept) < written + (4u << 20));
        ::close(kept);
    }
}

TEST_CASE("hostile shared memory: an event that nobody takes is given back untouched")
{
    HostilePeer peer;
    peer.end.wants = [](PacketType, std::uint16_t channel) { return channel == 7; };
    const int descriptor = memory(2 * largest, all_seals), kept = ::dup(descriptor);
    peer.offer({0, 2, largest}, descriptor);
    const Reference reference{{0, 1, 5}, 0, largest};
    peer.refer(reference);
    CHECK(peer.answer(PacketType::release) == text_of(hive::protocol::to_body(std::vector{reference.slot})));
    CHECK(backed_bytes(kept) == 0);
    CHECK(peer.end.closed == 0);
    CHECK(peer.end.packets.size() == 1);  // the hello
    peer.refer({{0, 2, 1}, 0, 10});       // outside all the same
    CHECK(verdict(peer) == Errc::malformed);
    ::close(kept);
}

TEST_CASE("hostile shared memory: slots larger than bodies can be are refused")
{
    HostilePeer peer;
    peer.offer({0, 4, 2 * largest}, memory(8 * largest, all_seals));
    CHECK(verdict(peer) == Errc::too_large);
}

TEST_CASE("hostile shared memory: at the end only what is held is copied, and no more is held than can be copied soon")
{
    HostilePeer little;
    little.offer({0, 8, largest}, memory(8 * largest, all_seals, 4096));
    little.refer({{0, 0, 1}, 0, 4096});
    REQUIRE(little.loop.until([&] { return little.end.has(2); }));
    const auto before = resident_bytes();
    little.raw->close();
    REQUIRE(little.until_closed());
    CHECK(little.end.packets[1].body.data()[4095] == 'w');
    if (!sanitized)
        CHECK(resident_bytes() < before + (1u << 20));

    HostilePeer much;
    much.offer({0, 1, largest}, memory(largest, all_seals, largest));
    for (std::uint64_t i = 1; i <= 9; ++i)
        much.refer({{0, 0, i}, 0, largest});
    CHECK(verdict(much) == Errc::too_large);
    CHECK(much.end.packets.size() == 9);  // the hello, and eight of nine
}

TEST_CASE("hostile shared memory: huge pages are refused, which lie otherwise than slots (needs huge pages)")
{
    const int descriptor = ::memfd_create("hostile", MFD_CLOEXEC | MFD_ALLOW_SEALING | MFD_HUGETLB);
    if (!hive::test::possible(descriptor >= 0 ? "" : "huge pages"))
        return;
    constexpr std::size_t huge = 2u << 20;
    REQUIRE(::ftruncate(descriptor, huge) == 0);
    REQUIRE(::fcntl(descriptor, F_ADD_SEALS, all_seals) == 0);
    HostilePeer peer;
    peer.offer({0, 1, huge}, descriptor);
    CHECK(verdict(peer) == Errc::malformed);
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
    int sent = 0;
    for (; sent < 20 && peer.end.closed == 0; ++sent) {
        const auto packet = encoded(PacketType::get, "{}");
        const asio::const_buffer bytes(packet.data(), packet.size());
        bool done = false;
        peer.raw->write_with(0, {&bytes, 1}, [&](std::error_code, std::size_t) { done = true; });
        REQUIRE(peer.loop.until([&] { return done; }));
        peer.loop.run_for(5ms);
    }
    CHECK(peer.until_closed());
    CHECK(open_descriptors() <= before);
    CHECK(sent <= 4);
}

TEST_CASE_TEMPLATE("hostile shared memory: on a connection that cannot share there is no such thing", Place, Tcp)
{
    RawPair pair(Place::address, patient);
    pair.write(hello());
    REQUIRE(pair.loop.until([&] { return pair.end.has(1); }));
    pair.write(encoded(PacketType::segment, hive::to_text(to_json(Segment{0, 8, slot_size}))));
    CHECK(pair.until_closed());
    CHECK(pair.end.code == Errc::malformed);
}
