// Parameters on the command line: key=value in, applied values out.
#pragma once

#include <hive/json.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// {"scale":"1.05"} from {"scale=1.05"}; values stay texts, the drone parses them by its declared type. Throws
/// Errc::invalid_argument on a word without '=', a key that is no name, and a key given twice.
hive::Json parse_settings(const std::vector<std::string>& words);

/// Values for people: the bare value when there is one, otherwise a line key=value for each.
std::string settings_text(const hive::Json& values);
/// A line "drone key=value" for each, for answers of several drones.
std::string settings_text(const std::string& drone, const hive::Json& values);

}  // namespace hivectl
