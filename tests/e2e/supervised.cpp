// A drone's notifications to its service manager, by the protocol of sd_notify(3).
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

class Supervisor {
public:
    explicit Supervisor(const std::filesystem::path& path) : socket_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0))
    {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        path.string().copy(address.sun_path, sizeof address.sun_path - 1);
        REQUIRE(::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    }
    ~Supervisor() { ::close(socket_); }
    Supervisor(const Supervisor&) = delete;
    Supervisor& operator=(const Supervisor&) = delete;

    /// The messages within this time, in order.
    [[nodiscard]] std::vector<std::string> hear(Milliseconds time) const
    {
        std::vector<std::string> heard;
        const auto end = std::chrono::steady_clock::now() + time;
        while (std::chrono::steady_clock::now() < end) {
            pollfd ready{socket_, POLLIN, 0};
            char text[4096];
            if (::poll(&ready, 1, 10) == 1)
                heard.emplace_back(text, static_cast<std::size_t>(::recv(socket_, text, sizeof text, 0)));
        }
        return heard;
    }
    [[nodiscard]] bool hears(const std::string& news) const
    {
        return eventually([&] { return std::ranges::count(hear(50ms), news) > 0; });
    }

private:
    int socket_;
};

}  // namespace

TEST_CASE("supervised: the drone says when it is ready, what it waits for, that it lives while its code is busy, and "
          "when it stops")
{
    const Swarm swarm;
    const auto path = swarm.home() / "told";
    const Supervisor supervisor(path);
    const std::vector<std::string> environment{"NOTIFY_SOCKET=" + path.string(), "WATCHDOG_USEC=300000"};
    const auto source = swarm.drone("ticker", "source", {"fps=50"});
    auto worker = swarm.drone("sleeper", "worker", {"start_ms=300", "work_ms=1"}, {}, environment);
    const auto start = supervisor.hear(200ms);
    REQUIRE_FALSE(start.empty());
    CHECK(start.front() == "READY=1\nWATCHDOG=1");

    auto application = swarm.application();
    application.connect({"source", ""}, {"worker", ""});
    application.set("worker", {{"work_ms", 2000}});
    CHECK(eventually([&] { return application.status("worker").busy_for_us > 300'000; }));
    static_cast<void>(supervisor.hear(1ms));
    CHECK(std::ranges::count(supervisor.hear(1000ms), "READY=1\nWATCHDOG=1") >= 5);

    worker.signal(SIGSTOP);
    static_cast<void>(supervisor.hear(200ms));
    CHECK(supervisor.hear(500ms).empty());
    worker.signal(SIGCONT);
    worker.signal(SIGTERM);
    CHECK(supervisor.hears("STOPPING=1"));

    const auto camera = swarm.drone("camera", "camera", {"source=rtsp://127.0.0.1:9/none"}, {}, environment);
    CHECK(eventually([&] {
        return std::ranges::any_of(supervisor.hear(50ms), [](const std::string& news) {
            return news.starts_with("STATUS=") && news.find("127.0.0.1:9") != std::string::npos;
        });
    }));
}
