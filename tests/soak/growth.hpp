// Memory and descriptors of drones, which may not grow however long a swarm runs.
#pragma once

#include <checks.hpp>

#include <cstdint>
#include <map>
#include <string>

namespace hive::soak {

struct Usage {
    std::int64_t memory = 0;  ///< bytes
    std::int64_t descriptors = 0;
};
using Usages = std::map<std::string, Usage>;  ///< by drone

class Growth {
public:
    /// growth: after its first looks a drone never has much more than in these, also after restarts.
    mixtures::Problems look(const Usages& usages);

private:
    struct Row {
        Usage most{};
        int looks = 0;
    };
    std::map<std::string, Row> rows_;
};

}  // namespace hive::soak
