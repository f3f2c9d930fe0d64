// Merges the reports of both ends of each connection of a swarm.
#pragma once

#include <hive/application.hpp>

#include <optional>
#include <string>
#include <vector>

namespace hive {

/// One connection as both ends report it, or a group as its sender reports it.
struct ConnectionEnds {
    std::string from, to;                      ///< "camera.image", "face.image"
    std::optional<EdgeStatus> at_sender{};     ///< nothing: unknown to the sender, or no answer
    std::optional<InputStatus> at_receiver{};  ///< nothing: an application, unknown there, or no answer
    /// Hosts of the two; empty: not a known drone.
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
