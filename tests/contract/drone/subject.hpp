// The drone binary under test: told by the environment, so that one suite serves every drone, also one outside this
// build.
#pragma once

#include "raw_peer.hpp"

#include <swarm.hpp>

#include <string>
#include <vector>

namespace subject {

using hive::test::Milliseconds;
using raw::Json;

/// HIVE_CONTRACT_PROGRAM: the binary. HIVE_CONTRACT_FOLDER: its source folder, with README.md.
std::filesystem::path program();
std::filesystem::path folder();
/// A deadline that only guards against hanging: three times as long, for a slow machine.
Milliseconds within(int milliseconds);

struct Ended {
    int exit_code = -1;
    std::string output;  ///< stdout and stderr
};
/// Runs the words to their end; the exit code is -1 if that takes longer than 20 s.
Ended run(const std::vector<std::string>& words, const std::vector<std::string>& environment = {});
/// Runs the binary without a home, and without the right to make a socket.
Ended run_offline(const std::vector<std::string>& arguments);
/// What --describe prints.
const Json& description();
/// The rows of description()["inputs"] that take images.
std::vector<std::string> image_inputs();
/// A number as pages and answers write it.
std::string written(double number);

/// A home with a drone of the kind under test in it, named "subject".
class Home {
public:
    Home() = default;
    [[nodiscard]] std::filesystem::path file(const std::string& ending) const
    {
        return swarm_.home() / ("subject" + ending);
    }
    /// Starts the drone and returns when it says hello.
    hive::test::Process start(const std::vector<std::string>& arguments = {}) const;
    /// Starts it and does not wait for anything.
    [[nodiscard]] hive::test::Process launch(const std::vector<std::string>& arguments = {},
                                             const std::string& log = "log") const;
    [[nodiscard]] raw::Peer meet(const std::string& name = "raw") const { return raw::Peer::meet(file(".sock"), name); }
    [[nodiscard]] bool answers() const;
    [[nodiscard]] std::string log(const std::string& log = "log") const;

private:
    hive::test::Swarm swarm_;
};

/// The confined half of run_offline: called by main with the words to run; does not return when it can run them.
int run_without_sockets(char** words);

}  // namespace subject
