// Writes YAML.
#pragma once

#include <nlohmann/json.hpp>

#include <string>

namespace hive {

using OrderedJson = nlohmann::ordered_json;

/// A value as a block of YAML; texts are quoted as in JSON, which is valid YAML.
/// @param indent  spaces before each line
std::string yaml_text(const OrderedJson& object, std::size_t indent = 0);

}  // namespace hive
