// A file in the runtime directory: this machine's daemon has just browsed the network. For some time its cache is then
// complete, since it receives announcements and withdrawals, and no browser need wait for answers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace hive::discovery {

class ListeningNote {
public:
    explicit ListeningNote(std::filesystem::path file) : file_(std::move(file)) {}

    /// The daemon's own random number. Nothing if the note is more than a minute old.
    [[nodiscard]] std::optional<std::uint32_t> daemon() const;
    /// Ignores errors: the next browser then waits.
    void write(std::uint32_t daemon) const noexcept;

private:
    std::filesystem::path file_;
};

}  // namespace hive::discovery
