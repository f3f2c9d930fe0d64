// The connections of a swarm, put together from what both ends report.
#pragma once

#include <hive/application.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hive {

/// What each end reports of one connection, or the sender of a group as a whole.
struct ConnectionEnds {
    std::string from, to;                      ///< "camera.image", "face.image"
    std::optional<EdgeStatus> at_sender{};     ///< nothing: the sender does not know it, or does not answer
    std::optional<InputStatus> at_receiver{};  ///< nothing: an application, or it does not know it or answer
    /// Where the two run; empty: not known as a drone.
    std::string from_host{}, to_host{};

    [[nodiscard]] const ConnectionOptions& options() const
    {
        return at_sender ? at_sender->options : at_receiver->options;
    }
    [[nodiscard]] bool is_group() const { return at_sender && at_sender->group; }
};

/// Sorted by sender, group and receiver, a group before its members.
std::vector<ConnectionEnds> connection_ends(const std::vector<StatusAnswer>& statuses);

}  // namespace hive
