// Builds the answer to `status`.
#pragma once

#include "listening.hpp"

#include <hive/event/mailbox.hpp>
#include <hive/event/module.hpp>

namespace hive::service {

/// The network side.
class StatusReport {
public:
    StatusReport(const Declaration& declaration, const StatusBoard& board, const event::Mailbox& mailbox,
                 event::Module& module, const Listening& listening, const DroneOrder& order)
        : declaration_(declaration),
          board_(board),
          mailbox_(mailbox),
          module_(module),
          listening_(listening),
          order_(order)
    {
    }

    /// As in SPEC.md, section 6.4, with all edges.
    [[nodiscard]] Status now() const;
    /// One page: as many rows as fit one answer, without the fields that are hidden from this role.
    [[nodiscard]] Status page(std::int64_t skip, Role role) const;

private:
    [[nodiscard]] Status without_rows() const;
    [[nodiscard]] DroneOrder order(const StatusBoard::Values& board) const;
    [[nodiscard]] const std::string& callback_of(const std::string& input) const;
    [[nodiscard]] std::vector<InputStatus> inputs() const;
    [[nodiscard]] std::vector<MatchingStatus> matching(const StatusBoard::Values& board) const;
    [[nodiscard]] Reason why(const StatusBoard::Values& board) const;

    const Declaration& declaration_;
    const StatusBoard& board_;
    const event::Mailbox& mailbox_;
    event::Module& module_;
    const Listening& listening_;
    const DroneOrder& order_;  ///< its start configuration
    event::Clock::time_point started_ = event::Clock::now();
};

}  // namespace hive::service
