// What made a drone fail: its inputs, kept in the home.
#pragma once

#include <hive/event.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace hive {

/// A drone's code threw, or its process died, and its inputs are kept. Of a drone that died each sender has kept what
/// the drone had in hand of it, so not each of the inputs is to blame.
struct KeptFailure {
    std::string drone;
    std::int64_t number = 0;   ///< of this drone, from 1; a larger one is newer
    std::int64_t time_us = 0;  ///< wall clock
    std::int64_t run = 0;      ///< of a drone that died: the epoch of its process; 0: its code threw
    /// The token of an error; "died"; "silent": it was cut off because it gave no sign of life; "late": a member of a
    /// group worked on it for longer than its lease.
    std::string code;
    std::string text;
    std::vector<Event> inputs;  ///< each with its `input`
};

}  // namespace hive
