// The requests to a drone that have more than an id, as values (SPEC.md, section 6.2).
#pragma once

#include <hive/json.hpp>
#include <hive/transfer.hpp>

#include <string>
#include <vector>

namespace hive::protocol {

/// Asks a drone to receive an output of another drone.
struct Connect {
    std::string drone, output;  ///< the sender
    std::string address = {};   ///< where the sender listens; empty: looked up by its name
    std::string input;          ///< of the receiver
    ConnectionOptions options;
};
Json to_json(const Connect& connect);
Connect connect_from_json(const Json& object);

/// Asks a drone to end connections of its inputs.
struct Disconnect {
    std::string drone, output = {};  ///< the sender; without output: all its outputs
    std::string input = {};          ///< empty: all inputs
};
Json to_json(const Disconnect& disconnect);
Disconnect disconnect_from_json(const Json& object);

/// Asks for the values of parameters.
struct Get {
    std::vector<std::string> names = {};  ///< empty: all
    bool asked = false;                   ///< as the values were asked for
};
Json to_json(const Get& get);
Get get_from_json(const Json& object);

/// Gives an event to an input. Its body is that of the packet.
struct Put {
    std::string input, type;
    Json header = Json::object();
    bool again = false;  ///< it is another drone's event, whose further fields are in the request, too
};
Json to_json(const Put& put);
Put put_from_json(const Json& object);

/// Asks a drone for new values of some parameters.
struct Set {
    static constexpr std::int64_t max_prepare_ms = 30'000;  ///< longer deadlines of a prepare are cut to this
    Json parameters = Json::object();
    bool check_only = false;                   ///< only check, change nothing
    std::optional<std::int64_t> prepare = {};  ///< hold the values until the set of this token is committed or aborted
    std::optional<std::int64_t> commit = {}, abort = {};  ///< decide the set of this token; without parameters
};
Json to_json(const Set& set);
Set set_from_json(const Json& object);

/// Asks a sender to stop waiting for a receiver that is gone: to drop its place, or the work of its group.
struct Forget {
    std::string output = {};  ///< empty: every output
    std::string receiver;     ///< the drone, or "drone.input"
};
Json to_json(const Forget& forget);
Forget forget_from_json(const Json& object);

}  // namespace hive::protocol
