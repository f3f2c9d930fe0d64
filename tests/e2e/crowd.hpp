// Many peers in one process that dial a drone repeatedly.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace hive::test {

/// Works on its own thread until it is destroyed. A served peer has sent hello and registered at an output.
class Crowd {
public:
    /// @param address  tcp://HOST:PORT
    /// @param key      a key file
    Crowd(const std::string& address, const std::filesystem::path& key);
    ~Crowd();
    Crowd(const Crowd&) = delete;
    Crowd& operator=(const Crowd&) = delete;

    /// Adds peers, which dial at once, and redial when they are rejected.
    void come(int peers);
    /// The number of peers served now.
    [[nodiscard]] int served() const;
    /// How often a served peer has lost its connection.
    [[nodiscard]] int lost() const;
    /// Closes all connections at once; the peers reconnect.
    void lose_connections();
    /// Adds peers that only connect: they send nothing, and redial when they are rejected.
    void come_silently(int peers);

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace hive::test
