// A drone's inputs, outputs and parameters, as `--describe` prints and `describe` returns them.
#pragma once

#include <hive/encoding.hpp>
#include <hive/json.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hive {

/// An input or an output. `type` is a comma-separated list of media types (see types_fit).
struct Port {
    std::string name;
    std::string type;
    std::string help;
    std::vector<Encoding> encodings{};  ///< of an output: the available ones, the preferred one first
};

enum class ParameterType { integer, number, text, flag };
std::string_view token(ParameterType type) noexcept;  // "integer", "number", "text", "flag"

/// A parameter and its constraints.
struct ParameterInfo {
    std::string name;
    ParameterType type = ParameterType::text;
    Json default_value;
    std::optional<double> least, most;  ///< inclusive, for integer and number
    std::vector<std::string> choices;   ///< not empty: a text that is one of these
    std::string unit;                   ///< "px", "fps", "%"
    std::string help;
    /// The parameter affects the drone's machine (files, addresses, logins) rather than its images: network peers may
    /// not set it, and viewers may not read it (libhive/docs/security.md).
    bool for_operator = false;
};

/// The port called `name`. Throws Errc::not_found: "face has no input imag".
/// @param what  "input" or "output"
const Port& port_named(const std::vector<Port>& ports, const std::string& drone, std::string_view what,
                       std::string_view name);
/// The port to use when none is named: the only one that matches.
/// @param which  how errors describe the matching ones: "that takes image/jpeg"; empty: all match
/// Throws Errc::not_found when there are no ports, Errc::type_mismatch when none matches, Errc::invalid_argument when
/// several do; the advice lists the ports.
const Port& port_meant(const std::vector<Port>& ports, const std::string& drone, std::string_view what,
                       std::string_view which, const std::function<bool(const Port&)>& fits);

/// Checks that a receiver that accepts the types `accepts` can receive this output in this encoding. Throws
/// Errc::invalid_argument when the output has no such encoding, and Errc::type_mismatch when the receiver does not
/// accept the encoded type.
void require_encoding(const Port& output, const std::string& encoding, const std::string& receiver,
                      const std::string& accepts);

/// The value of a parameter that is set to `value`: of its declared type (a text, as from a shell, is parsed) and
/// within its range. Throws Errc::refused, which says what is allowed.
Json checked_value(const ParameterInfo& parameter, const Json& value);

/// The range or the choices as readable text: "1.01 to 2", "jpeg | png | raw", or empty.
std::string range_text(const ParameterInfo& parameter);

/// The whole description of a drone.
struct Interface {
    std::string kind;     ///< "face": the program, whatever the drone's name in a swarm
    std::string summary;  ///< one sentence
    std::string version;
    bool stateful = false;  ///< remembers earlier events, so its work cannot be shared
    std::vector<Port> inputs, outputs;
    std::vector<ParameterInfo> parameters;

    /// The named port or parameter, or nullptr.
    [[nodiscard]] const Port* input(std::string_view name) const;
    [[nodiscard]] const Port* output(std::string_view name) const;
    [[nodiscard]] const ParameterInfo* parameter(std::string_view name) const;
};

Json to_json(const Interface& interface);
/// Reads what to_json wrote. Throws Errc::malformed.
Interface interface_from_json(const Json& object);

}  // namespace hive
