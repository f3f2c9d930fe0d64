// Runs the commands of a page as its reader would.
#pragma once

#include "swarm.hpp"

#include <fstream>
#include <string>
#include <vector>

namespace hive::test {

/// The contents of the blocks of a page between ```sh and ```.
inline std::vector<std::string> shell_blocks(const std::filesystem::path& page)
{
    std::vector<std::string> blocks;
    std::ifstream in(page);
    bool inside = false;
    for (std::string line; std::getline(in, line);)
        if (!inside && line == "```sh") {
            inside = true;
            blocks.emplace_back();
        } else if (line.starts_with("```")) {
            inside = false;
        } else if (inside) {
            blocks.back() += line + "\n";
        }
    return blocks;
}

/// The indented lines under a heading of a page, without the indent.
inline std::string indented_commands(const std::filesystem::path& page, const std::string& heading)
{
    std::string commands;
    std::ifstream in(page);
    bool inside = false;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("#"))
            inside = line == heading;
        else if (inside && line.starts_with("    "))
            commands += line.substr(4) + "\n";
    return commands;
}

/// @param seconds  for commands that stream
inline std::string reader_script(const Swarm& swarm, const std::string& commands, int seconds)
{
    return "program=" + swarm.program("hivectl").string() + "\ntimeout=" + std::to_string(seconds) + "\ncd "
           + swarm.home().string() + "\n. " HIVE_SOURCE_DIR "/tests/support/reader.sh\n" + commands;
}

inline Finished run_as_reader(const Swarm& swarm, const std::string& commands, int seconds)
{
    return swarm.run({"/bin/bash", "-c", reader_script(swarm, commands, seconds)}, Milliseconds(90'000));
}

}  // namespace hive::test
