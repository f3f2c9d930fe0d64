// Explains why a verb receives nothing.
#pragma once

#include <hive/explain.hpp>

#include <string>
#include <vector>

namespace hivectl {

/// Runs explain for the outputs, at most half a second at a time: the command keeps printing meanwhile.
hive::Explanation explain_silence(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// As a sentence: "camera has halted; try: hivectl resume camera", or where to look if no cause is found.
std::string silence_reason(hive::Application& application, const std::vector<hive::Endpoint>& outputs);

/// Prints on stderr what blocks the outputs, if anything does.
void report_silence(const std::string& verb, hive::Application& application,
                    const std::vector<hive::Endpoint>& outputs);

}  // namespace hivectl
