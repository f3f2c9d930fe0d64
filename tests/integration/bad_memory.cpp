// A peer whose shared memory cannot be used: that costs this peer, and nobody else.
#include "prey.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace hostile;

namespace {

constexpr int segment = 13, reference = 23;
constexpr std::size_t slot_size = 64 * 1024;

bool sends_with_descriptors(raw::Peer& peer, const std::string& bytes, const std::array<int, 2>& descriptors)
{
    iovec all{const_cast<char*>(bytes.data()), bytes.size()};
    alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof descriptors)> control{};
    msghdr message{};
    message.msg_iov = &all;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    auto* const part = CMSG_FIRSTHDR(&message);
    part->cmsg_level = SOL_SOCKET;
    part->cmsg_type = SCM_RIGHTS;
    part->cmsg_len = CMSG_LEN(sizeof descriptors);
    std::memcpy(CMSG_DATA(part), descriptors.data(), sizeof descriptors);
    return ::sendmsg(peer.descriptor(), &message, MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

/// In a process of its own, as another user of the drone would be.
template <class Attack>
int in_another_process(const Attack& attack)
{
    const pid_t child = ::fork();
    if (child == 0) {
        try {
            attack();
        } catch (const std::exception&) {
            ::_exit(1);
        }
        ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
}

bool maps(const raw::Peer& peer) { return peer.first().json().value("maps", false); }

}  // namespace

TEST_CASE(
    "hostile memory: a peer with memory that nobody wrote comes back without sharing, and the others go on sharing")
{
    const Prey prey("counter");
    REQUIRE(maps(prey.meet()));
    const auto attack = [&] {
        auto peer = prey.meet("attacker");
        const auto source = prey.swarm().home() / "evil.sock";
        raw::Listener listener(source);
        const Json from{{"drone", "evil"}, {"output", "tick"}, {"address", "unix:" + source.string()}};
        peer.send(raw::packet(raw::connect, 0, Json{{"id", 1}, {"from", from}, {"input", "tick"}}.dump()));
        auto sender = listener.accept();
        if (!sender)
            throw std::runtime_error("the drone does not dial");
        const Json hello{{"name", "evil"}, {"kind", "ticker"}, {"epoch", 1}, {"pid", ::getpid()}, {"maps", true}};
        sender->send(raw::packet(raw::hello, 0, hello.dump()));
        const auto registration = sender->next_of(raw::register_);
        if (!registration)
            throw std::runtime_error("the drone does not register");
        const Json result{{"type", "application/octet-stream"}, {"kind", "ticker"}, {"epoch", 1}};
        sender->send(
            raw::packet(raw::confirmation, 0, Json{{"id", registration->json().at("id")}, {"result", result}}.dump()));
        const int memory = ::memfd_create("hostile", MFD_CLOEXEC | MFD_ALLOW_SEALING);
        if (::ftruncate(memory, 2 * slot_size) != 0
            || ::fcntl(memory, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL) != 0)
            throw std::runtime_error("no memory");
        const Json offer{{"segment", 0}, {"slots", 2}, {"slot_size", slot_size}};
        sends_with_descriptors(*sender, raw::packet(segment, 0, offer.dump()), {memory, memory});
        std::string place(32, '\0');
        place[26] = 1;  // 65536 bytes
        const Json event{
            {"sender", "evil"}, {"kind", "ticker"}, {"output", "tick"}, {"type", "application/octet-stream"},
            {"source", "evil"}, {"epoch", 1},       {"seq", 1},         {"header", Json::object()}};
        sender->send(raw::packet(reference, registration->channel, event.dump(), place));
        if (!sender->closed_within(within(2000)))
            throw std::runtime_error("it was not refused");
        if (maps(prey.meet("attacker")))
            throw std::runtime_error("it may share again");
    };
    CHECK(in_another_process(attack) == 0);
    CHECK(maps(prey.meet()));
    CHECK(prey.well());
}

TEST_CASE("hostile memory: peers that send descriptors for nothing leave the drone enough for everybody else")
{
    const Prey prey("counter");
    const auto before = hive::test::open_descriptors(prey.pid());
    const int nothing = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    std::vector<raw::Peer> peers;
    for (int i = 0; i < 50; ++i) {
        peers.push_back(prey.meet());
        for (int k = 0; k < 8; ++k)
            sends_with_descriptors(peers.back(), raw::packet(raw::ping, 0, ""), {nothing, nothing});
    }
    CHECK(prey.well());
    CHECK(hive::test::open_descriptors(prey.pid()) <= before + 50 * 3);
    ::close(nothing);
}
