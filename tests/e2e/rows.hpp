// Parses the rows of hivectl --json, and finds one by name.
#pragma once

#include <hive/application.hpp>

#include <string>

namespace hive::test {

/// The first row with this value under a key; null if there is none.
inline Json row_named(const std::string& rows, const std::string& key, const std::string& name)
{
    for (const auto& row : Json::parse(rows))
        if (row.at(key) == name)
            return row;
    return nullptr;
}

}  // namespace hive::test
