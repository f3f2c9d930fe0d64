// GStreamer's RTSP server as a process of its own (../../support/rtsp/server.py), for tests and for
// scripts/measure-rtsp.
#pragma once

#include "swarm.hpp"

#include <optional>
#include <string>
#include <vector>

namespace hive::test {

/// Each test has ports of its own, since they may run at once; below the ephemeral ports of the system.
inline std::string rtsp_port(int number) { return std::to_string(20'000 + ::getpid() % 1'200 * 10 + number); }

/// Ended with this.
class RtspServer {
public:
    RtspServer(const Swarm& swarm, const std::string& port, const std::string& fps,
               const std::vector<std::string>& more = {})
        : log_(swarm.home() / ("rtsp-" + port + "-" + std::to_string(++count_))),
          url_("rtsp://127.0.0.1:" + port + "/live")
    {
        std::vector<std::string> words{"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/support/rtsp/server.py", port, fps};
        words.insert(words.end(), more.begin(), more.end());
        process_.emplace(words, std::vector<std::string>{"PATH=/usr/bin:/bin"}, log_);
        eventually([&] { return said() == "ready\n" || process_->wait(Milliseconds(0)); }, Milliseconds(20'000));
        ready_ = said() == "ready\n";
    }
    /// False where the server is not installed.
    [[nodiscard]] bool ready() const { return ready_; }
    [[nodiscard]] std::string said() const { return text_of(log_); }
    [[nodiscard]] const std::string& url() const { return url_; }
    void kill() { process_->kill(); }

private:
    static inline int count_ = 0;
    std::filesystem::path log_;
    std::string url_;
    std::optional<Process> process_;
    bool ready_ = false;
};

}  // namespace hive::test
