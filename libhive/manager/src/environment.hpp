// What a program that is started gets: its words and its environment, as exec takes them.
#pragma once

#include <string>
#include <vector>

namespace hive {

/// Our environment with some variables replaced: NAME=VALUE.
std::vector<std::string> environment_with(const std::vector<std::string>& replacements);
/// For exec; valid as long as the texts are.
std::vector<char*> pointers(const std::vector<std::string>& texts);

}  // namespace hive
