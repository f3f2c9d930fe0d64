// A branch beside the stages: a fork gives each event of the source on at two outputs, and another drone joins them.
#pragma once

#include "received.hpp"

#include <hive/application.hpp>

#include <functional>
#include <map>
#include <memory>

namespace hive::mixtures {

class Branch {
public:
    /// The fork and the joining drone must run. Connects them, and begins to receive all three outputs.
    explicit Branch(const Application::Options& options);

    /// Receives the next event, if one comes. @return whether one came
    bool take(std::chrono::milliseconds timeout);
    /// Epoch of the source's run, and number in it, of an event. @param index  in the run, as its header says
    using Place = std::function<std::pair<std::int64_t, std::int64_t>(const Identity&, std::int64_t index)>;
    /// What came of each output so far.
    [[nodiscard]] std::vector<Received> received(const Place& place) const;

private:
    Application application_;
    std::unique_ptr<Collector> outputs_;
    std::map<std::string, std::vector<std::pair<Identity, std::int64_t>>> came_;  ///< by output
};

}  // namespace hive::mixtures
