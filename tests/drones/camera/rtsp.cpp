// The camera drone and a real RTSP server (GStreamer's): slow streams, logins, a server that goes and comes back.
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

namespace fs = std::filesystem;

/// On a port of its own; says that the test is skipped, and is nothing, where GStreamer's server is not installed.
class Server {
public:
    Server(const Swarm& swarm, const std::string& port, const std::string& fps,
           const std::vector<std::string>& more = {})
        : log_(swarm.home() / ("rtsp-" + port + "-" + std::to_string(++count_))),
          url_("rtsp://127.0.0.1:" + port + "/live")
    {
        std::vector<std::string> words{"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/support/rtsp/server.py", port, fps};
        words.insert(words.end(), more.begin(), more.end());
        process_.emplace(words, std::vector<std::string>{"PATH=/usr/bin:/bin"}, log_);
        eventually([&] { return text_of(log_) == "ready\n" || process_->wait(0ms); }, 20'000ms);
        ready_ = text_of(log_) == "ready\n";
        if (!ready_)
            MESSAGE("skipped: no RTSP server here: ", text_of(log_));
    }
    [[nodiscard]] bool ready() const { return ready_; }
    [[nodiscard]] const std::string& url() const { return url_; }
    void kill() { process_->kill(); }

private:
    static inline int count_ = 0;
    fs::path log_;
    std::string url_;
    std::optional<Process> process_;
    bool ready_ = false;
};

std::string condition_of(hive::Application& application) { return application.status("camera").condition; }
bool says_so(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Each test has ports of its own, since they may run at once.
std::string port(int number) { return std::to_string(20'000 + ::getpid() % 4'000 * 10 + number); }

}  // namespace

TEST_CASE("rtsp: slow and quick streams open, over TCP and UDP")
{
    const Swarm swarm;
    int number = 0;
    for (const auto& [fps, transport] : {std::pair{"1", "tcp"}, {"12", "tcp"}, {"30", "udp"}}) {
        CAPTURE(std::string(fps));
        const Server server(swarm, port(number++), fps,
                            transport == std::string("udp") ? std::vector<std::string>{"--udp"}
                                                            : std::vector<std::string>{});
        if (!server.ready())
            return;
        const auto name = "camera-" + std::string(fps);
        const auto camera =
            swarm.drone("camera", name, {"source=" + server.url(), "transport=" + std::string(transport)});
        auto application = swarm.application();
        const auto pictures = application.collect({{name, "image"}});
        const auto event = pictures->next(patient(20'000ms));
        REQUIRE_MESSAGE(event, application.status(name).condition);
        CHECK(event->header.at("width") == 320);
        CHECK(application.status(name).condition.empty());
    }
}

TEST_CASE("rtsp: a login comes from a file, is said to be missing or wrong, and is seen nowhere")
{
    const Swarm swarm;
    const Server server(swarm, port(5), "30", {"--login", "viewer:s3cr:t/%"});
    if (!server.ready())
        return;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    CHECK(eventually([&] { return says_so(condition_of(application), "the camera wants a login"); }, 20'000ms));
    const auto file = swarm.home() / "login";
    const auto write = [&](const std::string& text) {
        std::ofstream(file) << text << '\n';
        fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
    };
    write("viewer:wrong");
    application.set("camera", {{"credentials", file.string()}});
    CHECK(eventually([&] { return says_so(condition_of(application), "refuses this login"); }, 20'000ms));
    CHECK(eventually([&] { return says_so(condition_of(application), "not tried again"); }, 20'000ms));
    write("viewer:s3cr:t/%");
    application.set("camera", {{"credentials", file.string()}});
    CHECK(application.collect({{"camera", "image"}})->next(patient(20'000ms)));
    CHECK_FALSE(says_so(swarm.log("camera"), "s3cr"));
    CHECK_FALSE(says_so(text_of("/proc/" + std::to_string(camera.pid()) + "/cmdline"), "s3cr"));
    CHECK_FALSE(says_so(application.get("camera").dump(), "s3cr"));
}

TEST_CASE("rtsp: a camera that goes away and comes back gives pictures again")
{
    const Swarm swarm;
    Server server(swarm, port(8), "30");
    if (!server.ready())
        return;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    const auto pictures = application.collect({{"camera", "image"}});
    REQUIRE(pictures->next(patient(20'000ms)));
    server.kill();
    CHECK(eventually([&] { return !condition_of(application).empty(); }, 20'000ms));
    while (pictures->next(0ms)) {
    }
    const Server again(swarm, port(8), "30");
    const auto event = pictures->next(patient(20'000ms));
    REQUIRE_MESSAGE(event, condition_of(application));
    CHECK(event->age() < patient(2000ms));
}
