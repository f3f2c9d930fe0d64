// The declarations of a drone's author before run(): parameters, ports, callbacks.
#pragma once

#include "parameter_set.hpp"

#include <hive/drone.hpp>
#include <hive/event/matcher.hpp>

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace hive::service {

/// The input of one callback: a set of matched events, usually a single event.
using Set = event::Matcher::Set;

/// Inputs whose events are matched. The inputs are fixed; the matcher is for the user thread.
struct MatchedInputs {
    std::vector<MatchedInput> inputs;
    event::Matcher matcher;
    std::function<void(const Set&)> callback;

    [[nodiscard]] const MatchedInput* input(const std::string& name) const;
};

/// Filled by the user thread before run(). From then on the interface is constant and read by both threads, the
/// parameters have their own mutex, and the functions and matchers are for the user thread.
class Declaration {
public:
    explicit Declaration(DroneProgram program);

    void add_input(const std::string& name, const std::string& type, std::function<void(const Event&)> callback,
                   const std::string& help);
    std::size_t add_matching(const std::vector<MatchedInput>& inputs, Match match,
                             std::function<void(const Set&)> callback);

    Interface interface;
    ParameterSet parameters;
    std::map<std::string, std::function<void(const Event&)>> callbacks;  ///< by input
    std::deque<MatchedInputs> matchings;
    std::function<void()> on_change = [] {}, on_start = [] {};
    std::function<void(const std::string&)> on_end = [](const std::string&) {};
    std::function<std::chrono::microseconds()> main;
};

}  // namespace hive::service
