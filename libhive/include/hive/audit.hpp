// Finds lost events by comparing the counts of both ends of each connection.
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
    bool promised = true;      ///< false: the options or the receiver allow it, such as skipped events of a live source
    std::int64_t last_us = 0;  ///< wall clock of the newest loss that this end counts; 0: not known
    std::string reason{};      ///< of abandoned events: the drone's last exception at that input; otherwise empty
};

/// One connection, or a group as a whole; or what an input lost in connections that were closed, or of what hivectl put
/// sent.
struct AuditRow {
    ConnectionEnds ends{};
    bool sender_answers = false;
    bool receiver_answers = false;  ///< also false for an application or a group
    std::vector<AuditLoss> losses{};
    std::vector<std::string> differences{};  ///< contradictions between the two ends, as sentences

    [[nodiscard]] std::int64_t lost() const;  ///< against a promise
};

struct Audit {
    std::vector<AuditRow> rows;
    std::vector<std::string> silent;  ///< drones that did not answer

    /// Do all counts agree, and was no promised event lost?
    [[nodiscard]] bool clean() const;
    /// Leaves out losses of connections whose newest loss is older. Counters have no history, so the others keep all
    /// events since the drone was started.
    /// @param time_us  wall clock
    void forget_before(std::int64_t time_us);
};

/// Queries all drones three times, because their counts are not of one instant: a receiver must have processed at the
/// third time at least as many events as its sender had acknowledged at the second, and at the second at most as many
/// as the sender has sent at the third. Whether both ends have the connection must differ all three times.
Audit audit(Application& application);
/// The same repeatedly: queries twice if `last` has the last answers of the call before.
/// @param last  empty for the first call; gets the last answers
Audit audit(Application& application, std::vector<StatusAnswer>& last);
/// The same from three answers of each drone, in their order. A drone that was started after the first is compared by
/// the other two.
Audit audit(const std::vector<StatusAnswer>& first, const std::vector<StatusAnswer>& second,
            const std::vector<StatusAnswer>& third);

/// {"from", "to", "state", "came", a count for each fate, "in_flight", "received", "processed", "lost", "fates": a
/// text, "losses": [{"fate", "at", "events", "promised", "last_us", "reason"}], "differences": [text], "verdict": "ok",
/// "lost" or "differs"}; a count is null if its end did not answer.
Json to_json(const AuditRow& row);
/// {"clean": flag, "connections": [rows as above], "silent": [drones]}
Json to_json(const Audit& audit);

}  // namespace hive
