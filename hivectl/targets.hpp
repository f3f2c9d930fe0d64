// From the words of a command line to drones and ports: globs, dots, and ports that need not be named.
#pragma once

#include "exit_code.hpp"

#include <hive/application.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hivectl {

/// Does a drone hold the name, even one that is only starting?
bool runs(hive::Application& application, const std::string& name);
bool is_glob(std::string_view text);
std::vector<std::string> texts_of(const std::vector<hive::Endpoint>& endpoints);

/// Adds those that are not there yet.
void add_new(std::vector<std::string>& names, std::vector<std::string> more);
/// The drones that the names and globs mean, each once, in the order given. A word without any is a failure of
/// `outcome`, and the others go on.
std::vector<std::string> drones_named(hive::Application& application, const std::vector<std::string>& words,
                                      Outcome& outcome);
/// The ends of connections that they mean: "face", "face.image", "face-*", "face-*.image". Throws Errc::not_found for a
/// glob without any.
std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words);
/// The same, but that is a failure of `outcome`, and the others go on.
std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words,
                                            Outcome& outcome);

/// The output meant when none is named: the only one whose type contains `preferred`, otherwise the only one there is.
std::string usual_output(const hive::Interface& interface, const std::string& drone, std::string_view preferred);
/// endpoints_named(), with the usual output where none is named. Outputs that do not exist are failures of `outcome`.
std::vector<hive::Endpoint> outputs_named(hive::Application& application, const std::vector<std::string>& words,
                                          std::string_view preferred, Outcome& outcome);
/// The input meant when none is named: the only one that takes `type`.
std::string usual_input(const hive::Interface& interface, const std::string& drone, const std::string& type);

/// The end of a connection that the word means, with the usual port where none is named.
hive::Endpoint output_named(hive::Application& application, const std::string& word, std::string_view preferred);
hive::Endpoint input_named(hive::Application& application, const std::string& word, const std::string& type);

}  // namespace hivectl
