// Resolves arguments to drones and ports: globs, dots, and inferred ports.
#pragma once

#include "words/exit_code.hpp"

#include <hive/application.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace hivectl {

/// Does a drone have the name, even one that is still starting?
bool runs(hive::Application& application, const std::string& name);
bool is_glob(std::string_view text);
std::vector<std::string> texts_of(const std::vector<hive::Endpoint>& endpoints);

/// Adds the missing ones.
void add_new(std::vector<std::string>& names, std::vector<std::string> more);
/// The drones of names and globs, each once, in the given order. An argument without a match is a failure of `outcome`;
/// the others are still processed.
std::vector<std::string> drones_named(hive::Application& application, const std::vector<std::string>& words,
                                      Outcome& outcome);
/// The ends of connections: "face", "face.image", "face-*", "face-*.image". Throws Errc::not_found for a glob without a
/// match.
std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words);
/// The same, but a glob without a match is a failure of `outcome`; the others are still processed.
std::vector<hive::Endpoint> endpoints_named(hive::Application& application, const std::vector<std::string>& words,
                                            Outcome& outcome);

/// The default output: the only one whose type contains `preferred`, otherwise the only one.
std::string usual_output(const hive::Interface& interface, const std::string& drone, std::string_view preferred);
/// endpoints_named(), with the default output if none is named. Outputs that do not exist are failures of `outcome`.
std::vector<hive::Endpoint> outputs_named(hive::Application& application, const std::vector<std::string>& words,
                                          std::string_view preferred, Outcome& outcome);
/// The default input: the only one that accepts `type`.
std::string usual_input(const hive::Interface& interface, const std::string& drone, const std::string& type);

/// The end of a connection, with the default port if none is named.
hive::Endpoint output_named(hive::Application& application, const std::string& word, std::string_view preferred);
hive::Endpoint input_named(hive::Application& application, const std::string& word, const std::string& type);

}  // namespace hivectl
