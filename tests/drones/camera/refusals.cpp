// The camera drone as a process, and network cameras that attack it: it reports why it refuses one, stays small, and
// takes another source at once.
#include "hostile_camera.hpp"
#include "hostile_media.hpp"
#include "swarm.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <filesystem>
#include <fstream>
#include <optional>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

bool told(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string login_file(const Swarm& swarm, const std::string& text)
{
    const auto file = swarm.home() / "login";
    std::ofstream(file) << text << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
    return file.string();
}

/// A certificate for 127.0.0.1 that signs itself, and a server that has it.
class Encrypted {
public:
    explicit Encrypted(const Swarm& swarm) : certificate_((swarm.home() / "own.pem").string())
    {
        const auto log = swarm.home() / "server.log";
        ready_ = swarm
                     .run({openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
                           "-nodes", "-days", "2", "-subj", "/CN=own", "-addext", "subjectAltName=IP:127.0.0.1",
                           "-keyout", certificate_ + ".key", "-out", certificate_})
                     .exit_code
                 == 0;
        if (!ready_)
            return;
        server_.emplace(std::vector<std::string>{openssl, "s_server", "-accept", "127.0.0.1:0", "-www", "-cert",
                                                 certificate_, "-key", certificate_ + ".key"},
                        std::vector<std::string>{}, log);
        ready_ = eventually([&] { return told(text_of(log), "ACCEPT 127.0.0.1:"); });
        const auto text = text_of(log);
        port_ = text.substr(text.find("127.0.0.1:") + 10);
        port_.resize(port_.find_first_not_of("0123456789"));
    }
    [[nodiscard]] bool ready() const { return ready_; }
    [[nodiscard]] std::string url() const { return "https://127.0.0.1:" + port_ + "/video"; }
    [[nodiscard]] const std::string& certificate() const { return certificate_; }

private:
    static constexpr const char* openssl = "/usr/bin/openssl";
    std::string certificate_, port_;
    std::optional<Process> server_;
    bool ready_ = false;
};

}  // namespace

TEST_CASE("camera refusals: a self-signed certificate is trusted only if the parameter names it")
{
    const Swarm swarm;
    const Encrypted server(swarm);
    if (!possible(server.ready() ? "" : "openssl"))
        return;
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    const auto condition = [&] { return application.status("camera").condition; };
    CHECK(eventually([&] { return told(condition(), "no encrypted connection: its certificate is not trusted"); }));
    CHECK(swarm.hivectl({"set", "camera", "certificate=/nowhere"}).exit_code != 0);
    application.set("camera", {{"certificate", server.certificate()}});
    // The page of that server is not a video, which is reported only after the connection.
    CHECK(eventually([&] { return told(condition(), server.url() + ": ") && !told(condition(), "no encrypted"); }));
}

TEST_CASE("camera refusals: the reason stands in the status and in the log, and another source is taken at once")
{
    const Swarm swarm;
    const hostile::Camera bomb([](hostile::Client& client, const std::string&) {
        client.send(hostile::multipart + hostile::part(hostile::grey_jpeg(16'000, 16'000)));
        return false;
    });
    const auto camera = swarm.drone("camera", "camera", {"source=" + bomb.url()});
    auto application = swarm.application();
    const std::string reason = bomb.url() + ": an image of 16000x16000 pixels; at most 40000000 are accepted";
    CHECK(eventually([&] { return application.status("camera").condition == reason; }, 8000ms));
    CHECK(told(swarm.log("camera"), reason));
    application.set("camera", {{"source", "scene"}});
    CHECK(application.collect({{"camera", "image"}})->next(patient(4000ms)));
    CHECK(application.status("camera").condition.empty());
}

TEST_CASE("camera refusals: a login goes unencrypted only where that is allowed, and to no camera but that of its file")
{
    const Swarm swarm;
    const hostile::Camera thief([](hostile::Client& client, const std::string&) {
        client.send("HTTP/1.1 401 No\r\nWWW-Authenticate: Basic realm=\"x\"\r\nContent-Length: 0\r\n\r\n");
        return false;
    });
    const auto camera = swarm.drone("camera", "camera",
                                    {"source=" + thief.url(), "credentials=" + login_file(swarm, "root:hush-hush")});
    auto application = swarm.application();
    const auto says = [&](const char* part) {
        return eventually([&] { return told(application.status("camera").condition, part); }, 8000ms);
    };
    CHECK(says("it accepts only an unencrypted password (basic authentication)"));
    CHECK_FALSE(told(thief.asked(), "Authorization"));
    const auto connections = thief.connections();
    login_file(swarm, "root:hush-hush\nhttp://192.0.2.1/video");
    application.set("camera", {{"basic_over_http", true}});
    CHECK(says("is for http://192.0.2.1, not for http://127.0.0.1:"));
    CHECK(thief.connections() <= connections + 1);
    CHECK_FALSE(told(thief.asked(), "Authorization"));
    login_file(swarm, "root:hush-hush\n" + thief.url("http", "/"));
    CHECK(eventually([&] { return told(thief.asked(), "Authorization: Basic"); }, 15'000ms));
}
