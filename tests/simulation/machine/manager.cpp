// There are no log files.
#include <hive/process.hpp>

namespace hive {

std::string last_lines(const std::filesystem::path&, std::size_t, std::uintmax_t) { return {}; }

}  // namespace hive
