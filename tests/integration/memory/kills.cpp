// A thousand SIGKILLs of either end of shared memory: no slot, descriptor, mapping or memory is lost, no image is
// broken.
#include "peers.hpp"
#include "process.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <optional>
#include <random>
#include <unistd.h>

namespace memory {
namespace {

using hive::test::Process;
using namespace std::chrono_literals;

constexpr int kills = hive::test::sanitized() ? 150 : 1000;
constexpr int warm_up = 20;  // what is allocated once is there after these

struct Usage {
    std::size_t descriptors, mappings, resident;

    static Usage now()
    {
        std::ifstream maps("/proc/self/maps");
        const auto lines = std::count(std::istreambuf_iterator<char>(maps), {}, '\n');
        return {hive::test::open_descriptors(::getpid()), static_cast<std::size_t>(lines),
                hive::test::resident_bytes(::getpid())};
    }
};

/// No more than at the beginning; the allocator's own growth and shrinking is allowed for.
void check_nothing_leaked(const Usage& before, const Usage& after)
{
    CHECK(after.descriptors <= before.descriptors);
    CHECK(after.mappings <= before.mappings + 4);
    if (!hive::test::sanitized())  // the sanitizer's memory grows with all that was ever freed
        CHECK(after.resident <= before.resident + (4u << 20));
}

/// Where peers meet, and the processes that come.
class Meeting {
public:
    Meeting()
    {
        std::string name = (std::filesystem::temp_directory_path() / "hive-memory-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        folder_ = name;
        listener_ =
            hive::transport::listen(context, {hive::transport::Address::Scheme::unix_socket, path(), 0},
                                    [this](std::shared_ptr<Connection> connection) { came = std::move(connection); });
    }
    ~Meeting()
    {
        listener_.reset();
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    Meeting(const Meeting&) = delete;
    Meeting& operator=(const Meeting&) = delete;

    [[nodiscard]] std::string path() const { return (folder_ / "place").string(); }
    /// A process of this very program in the other role; returns when it has dialed.
    Process meet(const std::string& role)
    {
        Process peer({"/proc/self/exe", "--peer", role, path()}, {}, folder_ / "log");
        REQUIRE(until([this] { return came != nullptr; }));
        return peer;
    }
    bool until(const std::function<bool()>& condition)
    {
        const auto end = hive::test::Clock::now() + hive::test::patient(10s);
        while (!condition() && hive::test::Clock::now() < end)
            context.run_one_for(10ms);
        return condition();
    }

    asio::io_context context;
    std::shared_ptr<Connection> came;

private:
    std::filesystem::path folder_;
    std::unique_ptr<hive::transport::Listener> listener_;
};

TEST_CASE("shared memory: receivers killed a thousand times give every slot back")
{
    Meeting meeting;
    std::mt19937 random(1);
    const auto pool = std::make_shared<Pool>();
    std::optional<Usage> before;
    int fallbacks = 0;
    for (int i = 0; i < kills; ++i) {
        if (i == warm_up)
            before = Usage::now();
        Process victim = meeting.meet("receiver");
        Producer producer(std::exchange(meeting.came, nullptr), pool);
        producer.start();
        const int enough = std::uniform_int_distribution(1, 12)(random);
        REQUIRE(meeting.until([&] { return producer.asked() >= enough; }));
        CHECK(pool->usage().slots_in_use >= 1);
        victim.signal(SIGKILL);
        REQUIRE(meeting.until([&] { return producer.closed(); }));
        REQUIRE(pool->usage().slots_in_use == 0);
        fallbacks += producer.fallbacks();
    }
    CHECK(fallbacks == 0);
    check_nothing_leaked(*before, Usage::now());
}

TEST_CASE("shared memory: producers killed a thousand times leave whole images and nothing else")
{
    Meeting meeting;
    std::mt19937 random(2);
    std::optional<Usage> before;
    std::deque<Body> inherited;  // from the producer that was killed last
    int broken = 0;
    for (int i = 0; i < kills; ++i) {
        if (i == warm_up)
            before = Usage::now();
        Process victim = meeting.meet("producer");
        Receiver receiver(std::exchange(meeting.came, nullptr));
        receiver.start();
        const int enough = std::uniform_int_distribution(2, 12)(random);
        REQUIRE(meeting.until([&] { return receiver.received() >= enough; }));
        victim.signal(SIGKILL);
        REQUIRE(meeting.until([&] { return receiver.closed(); }));
        broken += receiver.broken();
        inherited = receiver.take_kept();
        REQUIRE(inherited.size() == 2);
        broken += intact(inherited[0]) && intact(inherited[1]) ? 0 : 1;
    }
    CHECK(broken == 0);
    inherited.clear();
    check_nothing_leaked(*before, Usage::now());
}

}  // namespace
}  // namespace memory
