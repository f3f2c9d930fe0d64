// Runs hivectl dash, and sends requests with curl.
#pragma once

#include "swarm.hpp"

#include <doctest/doctest.h>
#include <free_port.hpp>

#include <csignal>

namespace hive::test {

/// hivectl dash, and curl.
class Page {
public:
    explicit Page(const Swarm& swarm, std::vector<std::string> more = {})
        : swarm_(swarm), server_(swarm.hivectl_running(words(std::move(more)), log_name()))
    {
        REQUIRE(eventually([&] { return has(swarm_.log(log_name()), "token="); }));
        const auto log = swarm_.log(log_name());
        token_ = log.substr(log.rfind("token=") + 6, 32);
        REQUIRE(token_.size() == 32);
    }
    [[nodiscard]] std::string cookie() const { return "hive-dash-" + std::to_string(port_) + "=" + token_; }
    [[nodiscard]] std::string address() const { return "http://127.0.0.1:" + std::to_string(port_); }
    [[nodiscard]] const std::string& token() const { return token_; }
    [[nodiscard]] int port() const { return port_; }
    [[nodiscard]] pid_t pid() const { return server_.pid(); }

    /// The output of curl with these arguments: the body, then the code.
    [[nodiscard]] std::string curl(const std::string& path, const std::vector<std::string>& more) const
    {
        std::vector<std::string> line{"/usr/bin/curl", "-sS", "-m", "20", "-w", "%{http_code}"};
        line.insert(line.end(), more.begin(), more.end());
        line.push_back(address() + path);
        const auto done = swarm_.run(line, patient(std::chrono::seconds(30)));
        CHECK_MESSAGE(done.exit_code == 0, done.err);
        return done.out;
    }
    [[nodiscard]] std::string get(const std::string& path) const { return curl(path, {"-b", cookie()}); }
    [[nodiscard]] std::string post(const std::string& body, const std::vector<std::string>& more = {}) const
    {
        std::vector<std::string> words{
            "-b", cookie(), "-H", "Origin: " + address(), "-H", "Content-Type: application/json"};
        words.insert(words.end(), {"--data-binary", body});
        words.insert(words.end(), more.begin(), more.end());
        return curl("/orders", words);
    }
    /// A request in the background; without a body it is a GET.
    [[nodiscard]] Process begin(const std::string& path, const std::string& body = "") const
    {
        std::vector<std::string> line{"/usr/bin/curl", "-sN", "-m", "60", "-b", cookie()};
        if (!body.empty())
            line.insert(line.end(),
                        {"-H", "Origin: " + address(), "-H", "Content-Type: application/json", "--data-binary", body});
        line.push_back(address() + path);
        return {line, {}, swarm_.home() / "requests"};
    }
    void stop()
    {
        server_.signal(SIGTERM);
        CHECK(server_.wait(patient(std::chrono::seconds(10))) == 143);
    }

private:
    [[nodiscard]] std::string log_name() const { return "dash-" + std::to_string(port_); }
    [[nodiscard]] std::vector<std::string> words(std::vector<std::string> more) const
    {
        more.insert(more.begin(), {"dash", "--http", std::to_string(port_)});
        return more;
    }

    const Swarm& swarm_;
    const int port_ = free_port();
    Process server_;
    std::string token_;
};

}  // namespace hive::test
