// How a fuzz target says that a promise is broken: loudly, in every build.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace hive::fuzz {

inline void require(bool kept, const char* promise)
{
    if (kept)
        return;
    std::fprintf(stderr, "broken: %s\n", promise);
    std::abort();
}

}  // namespace hive::fuzz
