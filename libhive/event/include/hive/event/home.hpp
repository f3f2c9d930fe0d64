// The directory where the modules of one user on one machine meet: a socket is a name, what a drone was told lies
// beside it.
#pragma once

#include <hive/json.hpp>
#include <hive/transport/address.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hive::event {

/// $HIVE_HOME, or $XDG_RUNTIME_DIR/hive, or /tmp/hive-UID.
std::filesystem::path default_home();

/// Made with mode 0700 when it is not there; one that others can enter is refused (Errc::not_permitted).
class Home {
public:
    explicit Home(std::filesystem::path directory);

    [[nodiscard]] const std::filesystem::path& directory() const noexcept { return directory_; }
    [[nodiscard]] transport::Address address(const std::string& name) const;
    /// Names that have a socket here, sorted; whether anybody answers is not looked at.
    [[nodiscard]] std::vector<std::string> names() const;

    /// Does a living module hold this name? (The kernel knows: nobody is asked.)
    [[nodiscard]] bool alive(const std::string& name) const;
    /// Does a process wait to take this name over from the one that holds it?
    [[nodiscard]] bool succession(const std::string& name) const;
    /// The process that claimed the name, or its succession, last; it may have ended. 0: none did.
    [[nodiscard]] std::int64_t holder(const std::string& name) const;
    [[nodiscard]] std::int64_t successor(const std::string& name) const;

    /// What a drone was told, kept across a crash.
    [[nodiscard]] std::optional<Json> read_state(const std::string& name) const;
    void write_state(const std::string& name, const Json& state) const;
    /// What a drone that died of a signal wrote of that, until the name is claimed again. Throws Errc::malformed.
    [[nodiscard]] std::optional<Json> read_crash(const std::string& name) const;
    /// And how it crashed.
    void forget_state(const std::string& name) const noexcept;
    [[nodiscard]] std::filesystem::path path(const std::string& name, std::string_view ending) const;

private:
    [[nodiscard]] bool locked(const std::string& name, std::string_view ending) const;

    std::filesystem::path directory_;
};

/// Writes a file that only its owner reads: whole, or not at all. Throws Errc::io.
void replace_file(const std::filesystem::path& file, const std::string& text);

/// The right to a name while it lives: a lock file, which the kernel frees when the process ends however it ends.
class NameClaim {
public:
    enum class To {
        name,
        succession  ///< to the name as soon as the one that holds it frees it
    };
    /// Throws Errc::name_taken with the holder's process id.
    NameClaim(const Home& home, const std::string& name, To what = To::name);
    ~NameClaim();
    NameClaim(const NameClaim&) = delete;
    NameClaim& operator=(const NameClaim&) = delete;

private:
    int descriptor_ = -1;
};

}  // namespace hive::event
