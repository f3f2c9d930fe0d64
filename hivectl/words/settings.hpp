// Parameters on the command line: key=value in, applied values out.
#pragma once

#include <hive/json.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// {"scale":"1.05"} from {"scale=1.05"}; values stay texts, the drone parses them by its declared type. Throws
/// Errc::invalid_argument for an argument without '=', an invalid key, and a repeated key.
hive::Json parse_settings(const std::vector<std::string>& words);

/// Values for people: a single value bare, several as lines key=value.
std::string settings_text(const hive::Json& values);
/// Answers of several drones, as lines "drone key=value".
std::string settings_text(const std::string& drone, const hive::Json& values);

}  // namespace hivectl
