// A note in a home: this machine's daemon has just asked the network who is there. For some time it then knows without
// asking, since it hears what is announced and taken back, and nobody need wait for answers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace hive::discovery {

class ListeningNote {
public:
    explicit ListeningNote(std::filesystem::path file) : file_(std::move(file)) {}

    /// Which daemon it was: the number that each has made for itself. Nothing when that is more than a minute ago.
    [[nodiscard]] std::optional<std::uint32_t> daemon() const;
    /// What cannot be written is left out: the next one waits.
    void write(std::uint32_t daemon) const noexcept;

private:
    std::filesystem::path file_;
};

}  // namespace hive::discovery
