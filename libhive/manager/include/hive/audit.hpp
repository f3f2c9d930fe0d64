// Whether anything was lost: the counts of both ends of each connection, side by side.
#pragma once

#include <hive/connection_ends.hpp>

#include <string>
#include <vector>

namespace hive {

/// Events of one connection that do not reach the receiver's code.
struct AuditLoss {
    std::string fate;  ///< "dropped", "lost_killed"; at the receiver: "abandoned", "dropped", "discarded" ...
    std::string at;    ///< the drone that counts it
    std::int64_t events = 0;
    bool promised = true;  ///< false: the options or the receiver ask for it, such as skipped events of a live source
};

/// One connection, or a group as a whole.
struct AuditRow {
    ConnectionEnds ends{};
    bool sender_answers = false;
    bool receiver_answers = false;  ///< false, too: an application, or a group
    std::vector<AuditLoss> losses{};
    std::vector<std::string> differences{};  ///< what the two ends contradict each other in, as sentences

    [[nodiscard]] std::int64_t lost() const;  ///< against a promise
};

struct Audit {
    std::vector<AuditRow> rows;
    std::vector<std::string> silent;  ///< drones that did not answer

    /// Does everything balance, and was nothing lost that was promised?
    [[nodiscard]] bool clean() const;
};

/// Asks all drones three times, so that counts that are not of one instant are compared only where they must agree:
/// what a receiver has dealt with at the second time is no less than what its sender knew of at the first, and no more
/// than what the sender has sent at the third.
Audit audit(Application& application);
/// The same of three answers of each drone, in the order in which they came.
Audit audit(const std::vector<StatusAnswer>& first, const std::vector<StatusAnswer>& second,
            const std::vector<StatusAnswer>& third);

/// {"from", "to", "state", "came", a count for each fate, "in_flight", "received", "processed", "lost", "fates": a
/// text, "losses": [{"fate", "at", "events", "promised"}], "differences": [text], "verdict": "ok", "lost" or
/// "differs"}; a count is null if its end did not answer.
Json to_json(const AuditRow& row);
/// {"clean": flag, "connections": [rows as above], "silent": [drones]}
Json to_json(const Audit& audit);

}  // namespace hive
