// A branch beside the stages: a fork gives each event of the source on at two outputs, and another drone joins them.
#pragma once

#include "numbering.hpp"
#include "received.hpp"

#include <hive/application.hpp>

#include <map>
#include <memory>

namespace hive::mixtures {

class Branch {
public:
    /// The fork and the joining drone must run. Connects them, and begins to receive all three outputs.
    explicit Branch(const Application::Options& options);

    /// Receives the next event, if one comes. @return whether one came
    bool take(std::chrono::milliseconds timeout);
    /// What came of each output so far.
    [[nodiscard]] std::vector<Received> received(const Numbering& numbering) const;

private:
    Application application_;
    std::unique_ptr<Collector> outputs_;
    std::map<std::string, std::map<std::pair<std::int64_t, std::int64_t>, int>> came_;  ///< by output
};

}  // namespace hive::mixtures
