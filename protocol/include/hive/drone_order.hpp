// A drone's start configuration, and one table of its fields for every reader, writer and comparison.
#pragma once

#include <hive/json.hpp>

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hive {

/// When an engine restarts a drone by itself.
enum class Restart { never, on_failure, always };

/// One drone, which is one process: `"face": {"count": 4, ...}` makes four of these, face-1 to face-4.
struct DroneOrder {
    std::string name{}, kind{};  ///< kind: "face" for hive-face, or a Python file, "edges.py"
    std::string host = "local";  ///< the machine's name in the file: the key in `engines`
    Json set = Json::object();   ///< initial parameters
    Restart restart = Restart::never;
    // Empty or false: the default of the table below.
    std::string on_exception{}, listen{}, advertise{}, key{}, log_level{};
    bool halted = false, insecure = false, remote_operator = false;
    int cpus = 0, memory_mib = 0, gpus = 0;  ///< for its engine; 0: not said
    // Only where the drone is started:
    std::vector<std::string> expected{};     ///< receivers, for --expect
    std::vector<std::string> connections{};  ///< of its inputs, for --connect
    std::string swarm{};                     ///< to which it will belong
    bool no_announce = false;
    bool change_if_shared = false;  ///< set parameters and connections even if another swarm started it
    /// More than 0: it replaces the running drone of its name, if it is ready within this time. See hive::replace().
    double take_over_s = 0;
    bool lose_state = false;  ///< the replaced drone may lose its memory of earlier events
    bool force = false;       ///< the replaced drone is killed if it does not answer

    bool operator==(const DroneOrder&) const = default;
};

/// One field of an order.
struct OrderField {
    enum class Type { kind, word, flag, address, file, amount };
    /// How a running drone gets another value; never: it does not.
    enum class Change { at_once, by_restart, never };

    std::string_view name;    ///< in a swarm file and in a status: "on_exception"
    std::string_view option;  ///< on a command line: "--on-exception"; empty: none
    Type type;
    std::variant<std::string DroneOrder::*, bool DroneOrder::*, int DroneOrder::*, Restart DroneOrder::*> member;
    std::string_view usual;                   ///< the default, for an empty text
    std::span<const std::string_view> words;  ///< the possible values of a keyword
    Change change;
    std::string_view placeholder;  ///< for the value in help texts: "FILE"
    bool for_operator;             ///< affects the machine: hidden from viewers
    std::string_view help;         ///< of the option
    int most = 0;                  ///< maximum of an amount; the minimum is 1

    /// A text, a boolean or a whole number.
    [[nodiscard]] Json value(const DroneOrder& order) const;
    /// The same, or the default where the order has no value.
    [[nodiscard]] Json in_force(const DroneOrder& order) const;
    /// Is a value given, even if it is the default?
    [[nodiscard]] bool is_said(const DroneOrder& order) const { return value(order) != value({}); }
    /// Is a value given that is not the default?
    [[nodiscard]] bool is_given(const DroneOrder& order) const;
    void copy(DroneOrder& to, const DroneOrder& from) const;
    /// Throws Errc::malformed for an invalid value of this field.
    void set(DroneOrder& order, const Json& value) const;
};

/// All fields except `name`, `host`, `set` and those used only at a start, in the order in which swarm files are
/// written.
std::span<const OrderField> order_fields();

/// "--on-exception", "halt", "--halted" ...: the arguments for every field that differs from its default.
std::vector<std::string> option_words(const DroneOrder& order);

/// The order in a status, without fields that have their default.
Json to_json(const DroneOrder& order);
/// Throws Errc::malformed.
DroneOrder drone_order_from_json(const Json& object);

}  // namespace hive
