// A drone that has its name for a while, and exits before it answers.
#pragma once

#include <filesystem>
#include <fstream>

namespace hive::test {

/// Writes the program hive-falls. It takes the lock of its name as a drone does, and exits 0.3 s later with code 7.
inline void write_falling_drone(const std::filesystem::path& folder)
{
    std::filesystem::create_directories(folder);
    const auto file = folder / "hive-falls";
    std::ofstream(file) << R"(#!/usr/bin/env python3
import fcntl, os, sys, time
if "--describe" in sys.argv:
    print('{"kind": "falls", "inputs": [], "outputs": [], "parameters": []}')
    sys.exit(0)
name = sys.argv[sys.argv.index("--name") + 1]
lock = open(os.environ["HIVE_HOME"] + "/" + name + ".lock", "w")
fcntl.lockf(lock, fcntl.LOCK_EX)
time.sleep(0.3)
print("no film left", flush=True)
sys.exit(7)
)";
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
}

}  // namespace hive::test
