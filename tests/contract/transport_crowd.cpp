// Many peers, few descriptors: the limits on those who have said nothing yet.
#include "transport_world.hpp"

#include <switched_off.hpp>

#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace world;
using hive::test::SwitchedOff;

namespace {

void limit_descriptors(rlim_t count)
{
    rlimit limit{};
    ::getrlimit(RLIMIT_NOFILE, &limit);
    limit.rlim_cur = count;
    ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// Leaves so many descriptors free, however the open ones are numbered.
void leave_descriptors(std::size_t count)
{
    limit_descriptors(200);
    std::vector<int> taken;
    for (int descriptor = ::dup(0); descriptor >= 0; descriptor = ::dup(0))
        taken.push_back(descriptor);
    for (std::size_t i = 0; i < count; ++i)
        ::close(taken.at(i));
}

std::chrono::microseconds processor_time()
{
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto time = [](const timeval& t) {
        return std::chrono::seconds(t.tv_sec) + std::chrono::microseconds(t.tv_usec);
    };
    return time(usage.ru_utime) + time(usage.ru_stime);
}

constexpr int spins = 1;

/// In a process of its own: 0 when running out of descriptors neither spins nor lasts.
int run_out_of_descriptors(const Address& place)
{
    Loop loop;
    std::vector<std::unique_ptr<End>> ends;
    const auto on_connection = [&](auto connection) {
        ends.push_back(std::make_unique<End>());
        ends.back()->start(std::move(connection));
    };
    const auto listener = hive::transport::listen(loop.context, place, on_connection, patient);
    for (int i = 0; i < 10; ++i)
        connect_raw(listener->address());  // closed by the end of the process
    leave_descriptors(3);
    const auto before = processor_time();
    loop.run_for(450ms);
    if (processor_time() - before > (sanitized ? 40ms : 20ms))  // others may use the machine as well
        return spins;
    if (ends.size() != 3)
        return 2;
    limit_descriptors(1024);
    return loop.until([&] { return ends.size() == 10; }) ? 0 : 3;
}

int in_a_child(int (*run)(const Address&), const Address& place)
{
    const pid_t child = ::fork();
    if (child == 0)
        ::_exit(run(place));
    int status = -1;
    REQUIRE(::waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

}  // namespace

TEST_CASE_TEMPLATE("crowd: running out of descriptors pauses accepting, spins not, and recovers", Place, Unix, Tcp)
{
    Folder folder;
    CHECK(in_a_child(run_out_of_descriptors, Place::address(folder)) == 0);
}

TEST_CASE_TEMPLATE("crowd: when accepting does not pause, running out of descriptors spins", Place, Unix, Tcp)
{
    const SwitchedOff pause("accept-pause");
    Folder folder;
    CHECK(in_a_child(run_out_of_descriptors, Place::address(folder)) == spins);
}

TEST_CASE_TEMPLATE("crowd: at most 64 peers without a hello are inside at once", Place, Unix, Tcp)
{
    Loop loop;
    Folder folder;
    std::vector<std::unique_ptr<End>> ends;
    const auto on_connection = [&](auto connection) {
        ends.push_back(std::make_unique<End>());
        ends.back()->start(std::move(connection));
    };
    const auto listener = hive::transport::listen(loop.context, Place::address(folder), on_connection, patient);
    std::vector<std::shared_ptr<Connection>> silent;
    for (int i = 0; i < 80; ++i)
        hive::transport::dial(
            loop.context, listener->address(), 5s,
            [&](auto connection) { silent.push_back(value_or_none(std::move(connection))); }, patient);
    REQUIRE(loop.until([&] { return silent.size() == 80 && ends.size() == 64; }));
    loop.run_for(30ms);
    CHECK(ends.size() == 64);
    silent[0]->start({});
    silent[0]->send(hive::protocol::make_packet(PacketType::hello, "{}"));  // opened: its place is free
    REQUIRE(loop.until([&] { return ends.size() == 65; }));
    ends[1]->connection->close({Errc::stopped, "go"});
    REQUIRE(loop.until([&] { return ends.size() == 66; }));
    loop.run_for(30ms);
    CHECK(ends.size() == 66);
}

TEST_CASE_TEMPLATE("crowd: a thousand silent peers cost little, and good ones beside them are served", Place, Unix, Tcp)
{
    Timing timing = patient;
    timing.first_packet = 50ms;
    Pair pair(Place::address, patient);
    const auto before = resident_bytes();
    // Each further connection of the pair's listener becomes its listening end; keep the good one apart.
    const auto good = pair.listening.connection;
    pair.listener.reset();
    std::vector<std::unique_ptr<End>> ends;
    const auto listener = hive::transport::listen(
        pair.loop.context, Place::address(pair.folder),
        [&](auto connection) {
            ends.push_back(std::make_unique<End>());
            ends.back()->start(std::move(connection));
            ends.back()->send(PacketType::hello, "{}");
        },
        timing);
    std::vector<int> silent;
    for (int i = 0; i < 1000; ++i)
        silent.push_back(connect_raw(listener->address()));
    End late;
    hive::transport::dial(
        pair.loop.context, listener->address(), 5s,
        [&](auto connection) {
            late.start(value_or_none(std::move(connection)));
            late.send(PacketType::hello, "{}");
        },
        patient);
    std::size_t most = 0;
    int asked = 0;
    int answered = 0;
    pair.listening.on_packet = [&](const Packet&) {
        good->send(hive::protocol::make_packet(PacketType::confirmation, "{}"));
    };
    pair.dialing.on_packet = [&](const Packet&) { ++answered; };
    const auto ask_and_look = [&] {
        most = std::max(most, resident_bytes());
        pair.listening.packets.clear();
        pair.dialing.packets.clear();
        for (; asked <= answered; ++asked)
            pair.dialing.send(PacketType::get, "{}");
        return late.has(1);
    };
    REQUIRE(pair.loop.until(ask_and_look, 20s));
    CHECK(answered > 20);
    CHECK(pair.dialing.closed == 0);
    if (!sanitized)
        CHECK(most < before + 5'000'000);
    for (const int descriptor : silent)
        ::close(descriptor);
}
