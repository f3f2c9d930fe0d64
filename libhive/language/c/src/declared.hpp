// Checks declarations at once, rather than when the drone runs.
#pragma once

#include <hive/interface.hpp>

#include <string>

namespace hive::c {

/// Throws Errc::invalid_argument if the input exists, or `types` are not media types ("image/*" is one).
void require_input(const Interface& declared, const std::string& name, const std::string& types);
/// The same for an output.
void require_output(const Interface& declared, const std::string& name, const std::string& types);
/// Throws Errc::invalid_argument if the parameter exists.
void require_parameter(const Interface& declared, const std::string& name);

}  // namespace hive::c
