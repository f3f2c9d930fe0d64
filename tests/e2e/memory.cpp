// Shared memory between drones: bodies are passed by reference; shortage and receivers that keep memory cost speed but
// no event; crashed drones leave nothing behind.
#include "measure.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <fstream>
#include <numeric>
#include <sys/resource.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

constexpr int megabyte = 1'000'000;

/// The row of the first receiver of a drone's first output.
hive::EdgeStatus first_receiver(hive::Application& application, const std::string& sender)
{
    return application.status(sender).outputs.at(0).edges.at(0);
}

bool whole(const hive::Event& event)
{
    const auto bytes = std::span(event.body.data(), event.body.size());
    return bytes.size() == static_cast<std::size_t>(megabyte)
           && std::accumulate(bytes.begin(), bytes.end(), std::int64_t{0}) == event.header.at("sum");
}

std::size_t shared_mappings(pid_t pid)
{
    std::ifstream maps("/proc/" + std::to_string(pid) + "/maps");
    std::size_t count = 0;
    for (std::string line; std::getline(maps, line);)
        count += line.find("memfd:hive") != std::string::npos ? 1 : 0;
    return count;
}

/// Holds for this process, and for those it starts meanwhile.
class Limit {
public:
    Limit(decltype(RLIMIT_FSIZE) resource, rlim_t most) : resource_(resource)
    {
        REQUIRE(::getrlimit(resource_, &before_) == 0);
        const rlimit little{.rlim_cur = most, .rlim_max = before_.rlim_max};
        REQUIRE(::setrlimit(resource_, &little) == 0);
    }
    ~Limit() { ::setrlimit(resource_, &before_); }
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

private:
    decltype(RLIMIT_FSIZE) resource_;
    rlimit before_{};
};

/// Addresses that this process uses, in bytes.
rlim_t addresses_in_use()
{
    std::ifstream statm("/proc/self/statm");
    rlim_t pages = 0;
    statm >> pages;
    REQUIRE(pages > 0);
    return pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

/// Even if this process is late, events in flight to it do not use up the sender's memory.
const hive::CollectOptions few_on_the_way{.connection = {.window = 8, .group = {}, .lease = {}}};

/// Takes a hundred lossless events; all are whole and in order.
hive::EdgeStatus take_hundred(const Swarm& swarm, hive::Application& application)
{
    const auto collector = application.collect({{"source", "tick"}}, few_on_the_way);
    int intact = 0;
    for (int i = 1; i <= 100; ++i) {
        const auto event = collector->next(patient(5000ms));
        REQUIRE(event);
        intact += whole(*event) && event->header.at("index") == i ? 1 : 0;
    }
    CHECK(intact == 100);
    CHECK(swarm.hivectl_done({"connections"}).find("source.tick") != std::string::npos);
    return first_receiver(application, "source");
}

}  // namespace

TEST_CASE("memory: between drones of one machine bodies go by reference")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "count=100", "bytes=1000000"});
    auto application = swarm.application();
    const auto row = take_hundred(swarm, application);
    CHECK(row.shared == 100);
    CHECK(row.fallback == 0);
}

TEST_CASE("memory: when memory is short the bodies go through the socket, counted, and none is lost")
{
    const Swarm swarm;
    std::optional<Process> source;
    {
        const Limit no_large_files(RLIMIT_FSIZE, 256 * 1024);
        source = swarm.drone("ticker", "source", {"pace=demand", "count=100", "bytes=1000000"});
    }
    auto application = swarm.application();
    const auto row = take_hundred(swarm, application);
    CHECK(row.shared == 0);
    CHECK(row.fallback == 100);
}

TEST_CASE("memory: a receiver that cannot map what is shared comes back and gets the bodies through the socket")
{
    if (!possible(missing_if_sanitized()))
        return;  // a sanitizer reserves many addresses
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"pace=demand", "bytes=1000000"});
    auto application = swarm.application();
    const Limit no_room(RLIMIT_AS, addresses_in_use() + 16 * megabyte);  // room for bodies, but not for a segment
    const auto collector = application.collect({{"source", "tick"}});
    int intact = 0;
    std::int64_t before = 0;
    for (int i = 0; i < 50; ++i) {
        const auto event = collector->next(patient(5000ms));
        REQUIRE(event);
        intact += whole(*event) && (i == 0 || event->identity.sequence == before + 1) ? 1 : 0;
        before = event->identity.sequence;
    }
    CHECK(intact == 50);
    CHECK(first_receiver(application, "source").shared == 0);
}

TEST_CASE("memory: a receiver that keeps every event takes nothing from the others")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source", {"fps=200", "bytes=1000000"});
    auto greedy = swarm.application(), modest = swarm.application();
    const auto keeping = greedy.collect({{"source", "tick"}});
    std::vector<hive::Event> kept;
    for (int i = 0; i < 60; ++i) {
        auto event = keeping->next(patient(5000ms));
        REQUIRE(event);
        kept.push_back(std::move(*event));
    }
    const auto other = modest.collect({{"source", "tick"}}, few_on_the_way);
    for (int i = 0; i < 100; ++i) {
        const auto event = other->next(patient(5000ms));
        REQUIRE(event);
        CHECK(whole(*event));
    }
    const auto status = modest.status("source");
    for (const auto& row : status.outputs.at(0).edges) {
        if (row.receiver == modest.name())
            CHECK(row.fallback == 0);
        else
            CHECK(row.fallback > 0);
    }
    CHECK(std::ranges::all_of(kept, whole));
}

TEST_CASE("memory: the dead leave no mapping and no descriptor behind")
{
    const Swarm swarm;
    const auto counter = swarm.drone("counter", "counter");
    std::optional<Process> source = swarm.drone("ticker", "source", {"fps=100", "bytes=1000000"});
    auto application = swarm.application();
    application.connect({"source", "tick"}, {"counter", "tick"});
    REQUIRE(eventually([&] { return shared_mappings(counter.pid()) == 1; }));
    const auto descriptors = open_descriptors(counter.pid());
    source->kill();
    CHECK(eventually([&] { return shared_mappings(counter.pid()) == 0; }));
    CHECK(open_descriptors(counter.pid()) <= descriptors);
    source = swarm.drone("ticker", "source", {"fps=100", "bytes=1000000"});
    CHECK(eventually([&] { return shared_mappings(counter.pid()) == 1; }));
    CHECK(eventually([&] { return open_descriptors(counter.pid()) <= descriptors; }));
}
