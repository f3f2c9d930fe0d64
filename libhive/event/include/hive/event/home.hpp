// The runtime directory, in which the modules of one user on one machine connect: a socket per name, and the saved
// state of each drone.
#pragma once

#include <hive/json.hpp>
#include <hive/transport/address.hpp>
#include <hive/transport/descriptor.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::event {

/// $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or /tmp/hive-UID.
std::filesystem::path default_home();

/// Created with mode 0700 if missing; a directory that others can enter is refused (Errc::not_permitted).
class Home {
public:
    explicit Home(std::filesystem::path directory);

    [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }
    [[nodiscard]] transport::Address address(const std::string& name) const;
    /// Names that have a socket here, sorted, or are just being taken over; a socket may be stale.
    [[nodiscard]] std::vector<std::string> names() const;

    /// Does a running module hold this name? Asks the kernel for the lock, not the module.
    [[nodiscard]] bool alive(const std::string& name) const;
    /// The open lock file if a running module holds this name, otherwise empty. It runs as long as is_locked().
    [[nodiscard]] transport::Descriptor lock_of(const std::string& name) const;
    [[nodiscard]] static bool is_locked(const transport::Descriptor& lock);
    /// Does a process wait to take this name over from its holder?
    [[nodiscard]] bool succession(const std::string& name) const;
    /// True while a process has the name or waits to take it over: a drone that is being replaced runs all the time.
    [[nodiscard]] bool runs(const std::string& name) const;
    /// The last process that claimed the name, or its succession; it may have ended. 0: none did.
    [[nodiscard]] std::int64_t holder(const std::string& name) const;
    [[nodiscard]] std::int64_t successor(const std::string& name) const;

    /// The state of a drone that is restored after a crash.
    [[nodiscard]] std::optional<Json> read_state(const std::string& name) const;
    /// Only one that has crashed or is replaced leaves a state.
    [[nodiscard]] bool has_state(const std::string& name) const;
    void write_state(const std::string& name, const Json& state) const;
    /// What a drone leaves that is started again at once. Writing this removes the state, and the other way round.
    [[nodiscard]] std::optional<Json> read_return(const std::string& name) const;
    void write_return(const std::string& name, const Json& left) const;
    /// The record of a crash by a signal, kept until the name is claimed again. Throws Errc::malformed.
    [[nodiscard]] std::optional<Json> read_crash(const std::string& name) const;
    /// And how it crashed.
    void forget_state(const std::string& name) const noexcept;
    [[nodiscard]] std::filesystem::path path(const std::string& name, std::string_view ending) const;

private:
    [[nodiscard]] transport::Descriptor lock_of(const std::string& name, std::string_view ending) const;

    std::filesystem::path directory_;
};

/// Writes a file that only its owner can read, atomically. Throws Errc::io.
void replace_file(const std::filesystem::path& file, const std::string& text);

/// Holds a name as long as it lives: a lock file, which the kernel frees however the process ends.
class NameClaim {
public:
    enum class To {
        name,
        succession  ///< to the name as soon as its holder frees it
    };
    /// Throws Errc::name_taken with the holder's process id.
    NameClaim(const Home& home, const std::string& name, To what = To::name);

private:
    transport::Descriptor lock_;
};

}  // namespace hive::event
