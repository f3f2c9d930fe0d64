// Runs the scenarios of dash_page.py and dash_people.py with hivectl dash in a real browser.
#pragma once

#include "eventually.hpp"

#include <possible.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace hive::test {

inline std::string missing_for_browser()
{
    if (sanitized())
        return missing_if_sanitized();
    if (!std::filesystem::exists("/usr/bin/chromium"))
        return "chromium; install it: scripts/install-deps --browser";
    return std::filesystem::exists("/usr/bin/dot") ? "" : "graphviz";
}

inline std::vector<std::string> browser_words(const std::string& file, const std::string& scenario)
{
    return {"/usr/bin/python3", HIVE_SOURCE_DIR "/tests/e2e/" + file + ".py", scenario};
}

}  // namespace hive::test
