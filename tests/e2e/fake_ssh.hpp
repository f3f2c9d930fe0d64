// Simulates another machine without a network: a home reached by a fake ssh.
#pragma once

#include "swarm.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace hive::test {

/// A fake ssh that reaches one machine: the other home. It supports only the arguments that hivectl uses, and remote
/// programs keep running when it is killed. me@gpu1 works; on me@gpu2 a drone named brief is killed as soon as it is
/// ready; no drone of me@gpu3 is reachable from here; me@gpu4 does not answer; me@gpu5 works and has its own key; bare
/// has no hivectl. Each takes SSH_PAUSE seconds, if that is set.
class FakeSsh {
public:
    FakeSsh(const Swarm& here, const Swarm& there)
        : here_(here), directory_(here.home() / "ssh"), path_(directory_.string() + ":" + std::getenv("PATH"))
    {
        std::filesystem::create_directory(directory_);
        const auto file = directory_ / "ssh";
        std::ofstream(file) << "#!/bin/sh\n"
                               "if [ \"$1\" = -G ]; then\n"
                               "  test $3 = me@gpu3 && echo hostname nowhere.invalid || echo hostname 127.0.0.1\n"
                               "  exit\n"
                               "fi\n"
                               "while [ \"$1\" != -- ]; do shift; done\n"
                               "sleep ${SSH_PAUSE:-0}\n"
                               "case $2 in\n"
                               "  me@gpu[13]) HIVE_HOME="
                            << there.home().string() << " PATH=" << there.program("hivectl").parent_path().string()
                            << ":$PATH setsid -w sh -c \"$3\" & wait $!; exit ;;\n"
                            << "  me@gpu2) HIVE_HOME=" << there.home().string()
                            << " PATH=" << there.program("hivectl").parent_path().string()
                            << ":$PATH; export HIVE_HOME PATH; sh -c \"$3\"; code=$?\n"
                               "    case $3 in *\"'start'\"*) kill -9 $(cat $HIVE_HOME/brief.lock) ;; esac\n"
                               "    exit $code ;;\n"
                               "  me@gpu4) exec sleep 100 ;;\n"
                               "  me@gpu5) XDG_CONFIG_HOME="
                            << there.home().string()
                            << "/config exec \"$0\" -- me@gpu1 \"$3\" ;;\n"
                               "  bare) PATH=/nowhere exec /bin/sh -c \"$3\" ;;\n"
                               "esac\n"
                               "echo 'ssh: Could not resolve hostname '$2 >&2\n"
                               "exit 255\n";
        std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    }
    /// The command that runs hivectl here with this ssh.
    [[nodiscard]] std::vector<std::string> words(const std::vector<std::string>& of_hivectl) const
    {
        std::vector<std::string> all{"/usr/bin/env", "PATH=" + path_, here_.program("hivectl").string()};
        all.insert(all.end(), of_hivectl.begin(), of_hivectl.end());
        return all;
    }
    [[nodiscard]] Finished hivectl(const std::vector<std::string>& of_hivectl) const
    {
        return here_.run(words(of_hivectl), Milliseconds(40'000));
    }

private:
    const Swarm& here_;
    std::filesystem::path directory_;
    std::string path_;
};

}  // namespace hive::test
