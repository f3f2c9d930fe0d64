// What a drone is started with, and one table of its fields for all that read, write or compare them.
#pragma once

#include <hive/json.hpp>

#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hive {

/// When an engine starts a drone again by itself.
enum class Restart { never, on_failure, always };

/// One drone: one process. Of `"face": {"count": 4, ...}` there are four of these, face-1 to face-4.
struct DroneOrder {
    std::string name{}, kind{};  ///< kind: "face" for hive-face, or a Python file, "edges.py"
    std::string host = "local";  ///< as the file calls the machine: what `engines` are looked up by
    Json set = Json::object();   ///< initial parameters
    Restart restart = Restart::never;
    // Empty or false: the default, which the table below has.
    std::string on_exception{}, listen{}, advertise{}, key{}, log_level{};
    bool halted = false, insecure = false, remote_operator = false;
    // Only where the drone is started:
    std::vector<std::string> expected{};     ///< receivers, for --expect
    std::vector<std::string> connections{};  ///< of its inputs, for --connect
    std::string swarm{};                     ///< that it will belong to
    bool no_announce = false;
    bool change_if_shared = false;  ///< parameters and connections hold even if another swarm brought it up
    /// More than 0: it takes over from the running drone of its name, if it is ready by then. See hive::replace().
    double take_over_s = 0;
    bool lose_state = false;  ///< that drone may lose what it remembers of earlier events

    bool operator==(const DroneOrder&) const = default;
};

/// One field of an order: each reader and writer of orders walks all of them.
struct OrderField {
    enum class Type { kind, word, flag, address, file };
    /// How a running drone gets another value; never: no drone is told.
    enum class Change { at_once, by_restart, never };

    std::string_view name;    ///< in a swarm file and in a status: "on_exception"
    std::string_view option;  ///< on a command line: "--on-exception"; empty: it has none
    Type type;
    std::variant<std::string DroneOrder::*, bool DroneOrder::*, Restart DroneOrder::*> member;
    std::string_view usual;                   ///< what an empty text stands for
    std::span<const std::string_view> words;  ///< of a word: what it may be
    Change change;
    std::string_view placeholder;  ///< for the value in a help: "FILE"
    bool for_operator;             ///< concerns the machine: a viewer is not told
    std::string_view help;         ///< of the option

    /// A text, or true or false.
    [[nodiscard]] Json value(const DroneOrder& order) const;
    /// The same with the default where the order says nothing.
    [[nodiscard]] Json in_force(const DroneOrder& order) const;
    /// Is a value given, even if it is the default?
    [[nodiscard]] bool is_said(const DroneOrder& order) const { return value(order) != value({}); }
    /// Is a value given that is not the default?
    [[nodiscard]] bool is_given(const DroneOrder& order) const;
    void copy(DroneOrder& to, const DroneOrder& from) const;
    /// Throws Errc::malformed when it is not a value of this field.
    void set(DroneOrder& order, const Json& value) const;
};

/// All fields but `name`, `host`, `set` and those for a start alone, in the order in which files have them.
std::span<const OrderField> order_fields();

/// "--on-exception", "halt", "--halted" ...: what the order says otherwise than the default.
std::vector<std::string> option_words(const DroneOrder& order);

/// What a status says of a running drone; what is as usual is left out.
Json to_json(const DroneOrder& order);
/// Throws Errc::malformed.
DroneOrder drone_order_from_json(const Json& object);

}  // namespace hive
