// A drone's service record on the local network, and how its receivers verify it (SPEC.md, section 10.2).
#pragma once

#include <hive/transport/key.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hive::discovery {

inline constexpr const char* service_type = "_hive._tcp";

/// Proves that a key holder made an announcement. Holders recognise the key by its fingerprint and check a proof:
/// members check `members_proof`, which viewers cannot make.
struct KeyProof {
    std::string fingerprint, proof, members_proof;
    bool operator==(const KeyProof&) const = default;
};

struct Announcement {
    std::string drone, kind;
    std::int64_t epoch = 0;          ///< of the drone's process
    std::string at{};                ///< "tcp://HOST:PORT" if it is not reachable at every address of its machine
    std::vector<KeyProof> proofs{};  ///< one for each key that the drone accepts, at most `most_proofs`

    static constexpr std::size_t most_proofs = 4;
    bool operator==(const Announcement&) const = default;
};

/// The service that an announcement describes.
struct Service {
    std::string host;  ///< "cam1" or "cam1.local", as Avahi calls the machine
    std::uint16_t port = 0;
};
/// Adds a proof for each key.
void prove(Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys);
/// Did a holder of one of these keys make it?
bool is_proved(const Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys);

/// The strings of the TXT record: "name=camera", ...
std::vector<std::string> to_txt(const Announcement& announcement);
/// Nothing if it is not a valid announcement of a drone: any program can publish records of this type.
std::optional<Announcement> from_txt(const std::vector<std::string>& txt);

/// The address to announce for a drone.
struct Spot {
    std::uint16_t port = 0;
    std::string at;  ///< see Announcement
};
/// The first address that other machines can reach: an advertised one, or else one where it listens, except on the
/// loopback. Nothing if there is none.
std::optional<Spot> announced_spot(const std::vector<std::string>& listen, const std::vector<std::string>& advertise);

/// A discovered drone.
struct Neighbour {
    Announcement said;
    std::string host;     ///< "cam1"
    std::string address;  ///< "tcp://192.0.2.7:7700"
    std::uint16_t port = 0;
    bool same_machine = false;
};
/// Nothing if it cannot be dialed.
/// @param address  an IPv4 or IPv6 address
std::optional<Neighbour> neighbour(const Announcement& said, const Service& service, const std::string& address,
                                   bool same_machine);
/// Each drone once, with the best of its addresses; of several announcements of one drone at one address, only the
/// newest is kept.
std::vector<Neighbour> without_repetitions(std::vector<Neighbour> neighbours);

}  // namespace hive::discovery
