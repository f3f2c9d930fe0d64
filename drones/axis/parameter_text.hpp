// Parses the answers of param.cgi to `list` and `update`, and writes the queries.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace axis {

/// Names without the leading "root.", values as the camera writes them.
using Parameters = std::map<std::string, std::string>;

struct ParameterList {
    Parameters values;                ///< converted to UTF-8
    std::vector<std::string> errors;  ///< the lines that start with `#`, without it; their status is 200
};

ParameterList parse_parameters(std::string_view body);

/// Why an `update` was refused; nothing if it was not.
std::optional<std::string> refusal_of(std::string_view body);

/// A value of an Axis stream or sensor for a query: everything but letters, digits and -._~ is percent-encoded.
std::string url_encoded(std::string_view text);

/// The query that lists groups or single parameters, and the one that sets values.
std::string list_query(const std::vector<std::string>& groups);
std::string update_query(const Parameters& values);

}  // namespace axis
