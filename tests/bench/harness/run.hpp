// What one run is to do, as words of a command line: `VARIANT TEST SIZE [name=value]...`.
#pragma once

#include "clock.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace hive::bench {

/// latency: paced, one way. throughput: back to back, nothing lost. sync: one request for each frame.
/// rpc: a question and an answer of 64 bytes.
enum class Test { latency, throughput, sync, rpc };
/// The controller starts the other roles, each a process, and reports. A load takes one core until it is ended.
enum class Role { controller, publisher, subscriber, server, client, load };

struct Run {
    std::string program;  ///< "raw_shm"
    std::string variant;  ///< "copy"
    Test test = Test::latency;
    std::size_t size = 64;  ///< of a frame, bytes
    int subscribers = 1;
    int frames = 45;       ///< of a latency run
    double seconds = 0.3;  ///< of any other run
    double rate = 60;      ///< of a latency run, frames a second
    int window = 0;        ///< frames or requests under way at once; 0: as the row sees fit
    bool busy = false;     ///< with one core taken by other work
    bool dial = false;     ///< each question on a connection of its own
    double timeout = 20;   ///< seconds until a run that hangs is given up

    // between the processes of one run
    Role role = Role::controller;
    int index = 0;           ///< which subscriber
    std::string place;       ///< names whatever they meet at
    std::uint16_t port = 0;  ///< free when the run began

    /// Does the name of the variant have this part? "tcp-direct-b256" has "direct".
    [[nodiscard]] bool is(const std::string& part) const;
};

std::string to_text(Test test);
/// Throws std::invalid_argument.
Run read_run(const std::string& program, const std::vector<std::string>& words);
/// What read_run reads.
std::vector<std::string> words_of(const Run& run);

}  // namespace hive::bench
