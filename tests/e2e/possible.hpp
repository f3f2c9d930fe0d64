// Whether what a test needs is here; if not, the test says what is missing, and ends.
#pragma once

#include <doctest/doctest.h>

#include <string>

namespace hive::test {

inline bool possible(const std::string& missing)
{
    if (!missing.empty())
        MESSAGE("left out: it needs " << missing);
    return missing.empty();
}

}  // namespace hive::test
