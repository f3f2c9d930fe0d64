// What a verb that gets nothing says.
#pragma once

#include <hive/explain.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// Why nothing comes from the outputs, asked for half a second at a time: the command is printing meanwhile.
hive::Explanation explain_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// In words: "camera has halted; try: hivectl resume camera", or where to look if nothing is found.
std::string reason_for_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// Prints on stderr what holds the outputs up, if anything does.
void report_silence(const std::string& verb, hive::Application& application,
                    const std::vector<hive::Endpoint>& outputs);

}  // namespace hivectl
