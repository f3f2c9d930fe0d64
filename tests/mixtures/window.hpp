// How much receivers may have in hand at once.
#pragma once

#include "checks.hpp"

namespace hive::mixtures {

/// window: a synchronized receiver has no more unprocessed events in hand than its window; one of a stream no more than
/// 64 lossless ones (SPEC.md, section 5.4), also when it registers again. One that is connected with a smaller window
/// keeps what it has.
class Window {
public:
    /// @param lossless  whether the source produces on demand
    explicit Window(bool lossless) : lossless_(lossless) {}

    Problems look(const Statuses& statuses);

private:
    struct Row {
        std::int64_t registration = 0, taken_over = 0;
        bool again = false;  ///< it has registered before
    };
    void look(const std::string& drone, const InputStatus& input, Problems& problems);
    void look(const std::string& sender, const std::string& output, const EdgeStatus& edge, Problems& problems);
    [[nodiscard]] bool tells_all(const std::string& sender, const EdgeStatus& edge) const;
    bool fits(const std::string& key, std::int64_t registration, std::int64_t in_hand, std::int64_t window);

    bool lossless_;
    std::map<std::string, Row> rows_;  ///< by life of a drone and by edge
};

}  // namespace hive::mixtures
