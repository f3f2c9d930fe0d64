// https: whose certificates are trusted. Needs openssl, and a file system of its own for the drone.
#include "stage.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>

#include <filesystem>

using namespace stage;

namespace {

namespace fs = std::filesystem;

/// A folder with a certificate for 127.0.0.1 that signs itself, as the certificates of the system lie there, and its
/// key beside the folder.
fs::path certificate(const Swarm& swarm, const std::string& name)
{
    const auto folder = swarm.home() / name;
    fs::create_directory(folder);
    const auto made =
        swarm.run({"/usr/bin/openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
                   "-nodes", "-days", "2", "-subj", "/CN=" + name, "-addext", "subjectAltName=IP:127.0.0.1", "-keyout",
                   folder.string() + ".key", "-out", (folder / "camera.pem").string()});
    REQUIRE_MESSAGE(made.exit_code == 0, made.err);
    REQUIRE(swarm.run({"/usr/bin/openssl", "rehash", folder.string()}).exit_code == 0);
    fs::copy_file(folder / "camera.pem", folder / "ca-certificates.crt");
    return folder;
}

/// A server with a certificate, and drones to which another folder holds the certificates of the system.
class Encrypted {
public:
    Encrypted(const Swarm& swarm, const fs::path& own)
        : swarm_(swarm),
          log_(swarm.home() / "server.log"),
          server_({"/usr/bin/openssl", "s_server", "-accept", "127.0.0.1:0", "-www", "-cert",
                   (own / "camera.pem").string(), "-key", own.string() + ".key"},
                  {}, log_)
    {
        REQUIRE(eventually([&] { return has(text_of(log_), "ACCEPT 127.0.0.1:"); }));
        const auto log = text_of(log_);
        port_ = log.substr(log.find("127.0.0.1:") + 10);
        port_.resize(port_.find_first_not_of("0123456789"));
    }
    [[nodiscard]] Process drone(const fs::path& of_the_system, const std::string& certificate) const
    {
        const std::string script = "mount --bind " + of_the_system.string() + " /etc/ssl/certs && exec hive-axis "
                                   + "--set url=https://127.0.0.1:" + port_ + " --set allow_address=127.0.0.1"
                                   + " --set certificate=" + certificate;
        const char* path = std::getenv("PATH");
        return Process({"/usr/bin/unshare", "-Urm", "/bin/sh", "-c", script},
                       {"HIVE_HOME=" + swarm_.home().string(),
                        "PATH=" + swarm_.program("").string() + ":" + (path ? path : "/bin")},
                       swarm_.home() / "axis.log");
    }

private:
    const Swarm& swarm_;
    fs::path log_;
    Process server_;
    std::string port_;
};

std::string condition_of_a_drone(const Swarm& swarm, const Encrypted& camera, const fs::path& of_the_system,
                                 const std::string& certificate = "")
{
    const auto drone = camera.drone(of_the_system, certificate);
    auto application = swarm.application();
    std::string said;
    eventually(
        [&] {
            const auto answer = application.status(std::vector<std::string>{"axis"}).at(0);
            return !(said = value_or_none(answer.status).condition).empty();
        },
        Milliseconds(10'000));
    application.stop("axis");
    return said;
}

}  // namespace

TEST_CASE("axis certificate: the one that is named is trusted and no other, also not one of the system (needs openssl)")
{
    const Swarm swarm;
    const bool mountable = swarm.run({"/usr/bin/unshare", "-Urm", "/usr/bin/openssl", "version"}).exit_code == 0
                           && fs::is_directory("/etc/ssl/certs");
    if (!possible(mountable ? "" : "openssl, /etc/ssl/certs and the right to mount a folder"))
        return;
    const auto own = certificate(swarm, "own"), other = certificate(swarm, "other");
    const Encrypted camera(swarm, own);
    const std::string refused = "no encrypted connection";
    CHECK(has(condition_of_a_drone(swarm, camera, other), refused));
    const auto by_the_system = condition_of_a_drone(swarm, camera, own);
    CHECK_FALSE(has(by_the_system, refused));  // the twin: it comes as far as the answer, which is no camera's
    CHECK(by_the_system != "");
    CHECK_FALSE(has(condition_of_a_drone(swarm, camera, other, (own / "camera.pem").string()), refused));
    CHECK(has(condition_of_a_drone(swarm, camera, own, (other / "camera.pem").string()), refused));
}
