// A branch beside the stages: a fork gives each event of the source on at two outputs, and another drone joins them.
#pragma once

#include "numbering.hpp"
#include "received.hpp"

#include <swarm.hpp>

#include <map>
#include <memory>
#include <thread>

namespace hive::mixtures {

class Branch {
public:
    /// The fork and the joining drone must run. Connects them, and receives all three outputs.
    explicit Branch(const test::Swarm& swarm);

    /// What came of each output; it receives nothing more.
    std::vector<Received> received(const Numbering& numbering);

private:
    void run(const std::stop_token& ending);

    Application application_;
    std::unique_ptr<Collector> outputs_;
    std::map<std::string, std::map<std::pair<std::int64_t, std::int64_t>, int>> came_;  ///< by output
    std::jthread thread_;  // the last: it uses all the others
};

}  // namespace hive::mixtures
