// What a drone tells the local network of itself, and what is believed of what strangers tell (SPEC.md, section 10.2).
#pragma once

#include <hive/key.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hive::discovery {

inline constexpr const char* service_type = "_hive._tcp";

/// That a holder of a key announces this. Who holds the key knows it by its fingerprint and can check a proof: members
/// that of members, which no viewer can make.
struct KeyProof {
    std::string fingerprint, proof, members_proof;
    bool operator==(const KeyProof&) const = default;
};

struct Announcement {
    std::string drone, kind;
    std::int64_t epoch = 0;          ///< of the drone's process
    std::string at{};                ///< "tcp://HOST:PORT" when it is not met at every address of its machine
    std::vector<KeyProof> proofs{};  ///< one for each key that the drone takes, `most_proofs` at most

    static constexpr std::size_t most_proofs = 4;
    bool operator==(const Announcement&) const = default;
};

/// The service of which an announcement speaks.
struct Service {
    std::string host;  ///< "cam1" or "cam1.local", as Avahi calls the machine
    std::uint16_t port = 0;
};
/// Adds the proofs of the keys.
void prove(Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys);
/// Is it of a holder of one of these keys?
bool is_proved(const Announcement& announcement, const Service& service, const std::vector<SwarmKey>& keys);

/// The strings of the TXT record: "name=camera", ...
std::vector<std::string> to_txt(const Announcement& announcement);
/// Nothing when it is none of a drone: anybody may write anything there.
std::optional<Announcement> from_txt(const std::vector<std::string>& txt);

/// Where a drone is to be announced.
struct Spot {
    std::uint16_t port = 0;
    std::string at;  ///< as of Announcement
};
/// The first address that others can reach: what is advertised, or else where it listens, but on the loopback. Nothing
/// when there is none.
std::optional<Spot> announced_spot(const std::vector<std::string>& listen, const std::vector<std::string>& advertise);

/// A drone as it was found.
struct Neighbour {
    Announcement said;
    std::string host;     ///< "cam1"
    std::string address;  ///< "tcp://192.0.2.7:7700"
    std::uint16_t port = 0;
    bool same_machine = false;
};
/// Nothing when it cannot be dialed.
/// @param address  a number, of IPv4 or IPv6
std::optional<Neighbour> neighbour(const Announcement& said, const Service& service, const std::string& address,
                                   bool same_machine);
/// Each drone once, of several ways to it the one that is best to dial; what announces the same drone at the same place
/// again is older, and left out.
std::vector<Neighbour> without_repetitions(std::vector<Neighbour> neighbours);

}  // namespace hive::discovery
