// The inputs that made a drone fail, kept in the runtime directory.
#pragma once

#include <hive/event.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace hive {

/// A drone's code threw, or its process died, and its inputs are kept. If the process died, each sender kept the events
/// that the drone had in progress, so not every input is to blame.
struct KeptFailure {
    std::string drone;
    std::int64_t number = 0;   ///< of this drone, from 1; a larger one is newer
    std::int64_t time_us = 0;  ///< wall clock
    std::int64_t run = 0;      ///< the epoch of the process that died; 0: its code threw
    /// The token of an error; "died"; "silent": it was cut off for inactivity; "late": a member of a group worked on
    /// the event for longer than its lease.
    std::string code;
    std::string text;
    std::vector<Event> inputs;  ///< each with its `input`
    // Only in a file that save_failure() wrote, if known there: the program of the drone, and what it was given.
    std::string kind{}, version{};
    Json parameters = Json::object();
};

}  // namespace hive
