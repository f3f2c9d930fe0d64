// Many peers in one process, who dial a drone again and again.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace hive::test {

/// Works on a thread of its own until it is destroyed. Who is served has said hello, and has an output registered.
class Crowd {
public:
    /// @param address  tcp://HOST:PORT
    /// @param key      a key file
    Crowd(const std::string& address, const std::filesystem::path& key);
    ~Crowd();
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    /// Peers come, all at once, and come back when they are sent away.
    void come(int peers);
    /// Those of them who are served now.
    [[nodiscard]] int served() const;
    /// How often one of them who was served has lost its connection.
    [[nodiscard]] int lost() const;
    /// All that are connected lose their connection at once, and come back.
    void lose_connections();
    /// Others come, who only hold the door: they connect, say nothing, and come again when they are sent away.
    void come_silently(int peers);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
