// What is asked of a drone, as values, where a request has more than an id (SPEC.md, section 6.2).
#pragma once

#include <hive/json.hpp>
#include <hive/transfer.hpp>

#include <string>

namespace hive::protocol {

/// Asks a drone to receive an output of another one.
struct Connect {
    std::string drone, output;  ///< who sends
    std::string address = {};   ///< where the sender listens; empty: it is found by its name
    std::string input;          ///< of the drone that is asked
    ConnectionOptions options;
};
Json to_json(const Connect& connect);
Connect connect_from_json(const Json& object);

/// Asks a drone for new values of some parameters.
struct Set {
    static constexpr std::int64_t max_prepare_ms = 30'000;  ///< a longer deadline of a prepare counts as this one
    Json parameters = Json::object();
    bool check_only = false;                   ///< the answer is wanted, not the change
    std::optional<std::int64_t> prepare = {};  ///< hold them until the set of this token is committed or aborted
    std::optional<std::int64_t> commit = {}, abort = {};  ///< decide about the set of this token, without parameters
};
Json to_json(const Set& set);
Set set_from_json(const Json& object);

/// Asks a sender to wait no longer for a receiver that is gone: with its place, or with the work of its group.
struct Forget {
    std::string output = {};  ///< empty: every output
    std::string receiver;     ///< the drone, or "drone.input"
};
Json to_json(const Forget& forget);
Forget forget_from_json(const Json& object);

}  // namespace hive::protocol
