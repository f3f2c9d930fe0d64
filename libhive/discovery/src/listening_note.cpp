// Stores one number in a file, with the file's modification time.
#include "listening_note.hpp"

#include <hive/platform/whole_file.hpp>

#include <chrono>
#include <fstream>

namespace hive::discovery {
namespace fs = std::filesystem;

namespace {

constexpr auto holds_for = std::chrono::seconds(60);

}  // namespace

std::optional<std::uint32_t> ListeningNote::daemon() const
{
    std::error_code none;
    const auto written = fs::last_write_time(file_, none);
    const auto age = fs::file_time_type::clock::now() - written;
    std::uint32_t daemon = 0;
    if (none || age < age.zero() || age > holds_for || !(std::ifstream(file_) >> daemon))
        return std::nullopt;
    return daemon;
}

void ListeningNote::write(std::uint32_t daemon) const noexcept
try {
    static_cast<void>(platform::write_whole(file_, std::to_string(daemon) + '\n'));
} catch (const std::exception&) {
}

}  // namespace hive::discovery
