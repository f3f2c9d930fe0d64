// The key of a swarm and its file: holders can connect over TCP (libhive/docs/security.md).
#pragma once

#include <hive/role.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

struct SwarmKey {
    using Secret = std::array<unsigned char, 32>;

    std::string id;            ///< 16 hexadecimal digits, not secret; the same for members and viewers of one key
    Role role = Role::member;  ///< or viewer
    Secret secret{};
    std::int64_t created_s = 0;  ///< seconds since 1970
    std::int64_t until_s = 0;    ///< valid until then, in seconds since 1970; 0: unlimited
};

/// Generates a members' key from random bytes.
SwarmKey new_swarm_key(std::int64_t now_s);
/// The viewers' key, derived from the members' key, which cannot be computed from it.
SwarmKey viewers_key(const SwarmKey& members);
/// Is the key valid at that time?
inline bool holds(const SwarmKey& key, std::int64_t now_s) { return key.until_s == 0 || now_s < key.until_s; }

/// The fingerprint that a drone announces on the local network, by which members and viewers recognise its key. It is
/// derived from the viewers' key for this use alone, so it does not help to guess a key, nor to link the drone to the
/// key's id.
std::string announced_fingerprint(const SwarmKey& key);
/// Proves that a key holder announced a text; different for each text, and for members and viewers. Anyone who can
/// check a proof could also have made it.
std::string announcement_proof(const SwarmKey& key, std::string_view text);

/// The key file of this user: $HIVE_KEY, or $XDG_CONFIG_HOME/hive/swarm.key, or ~/.config/hive/swarm.key. Empty when
/// HIVE_KEY is "none": no key is used, even if the file exists.
std::filesystem::path default_key_file();
/// Did the user set HIVE_KEY to a file? Then a missing file is an error.
bool key_file_is_named();

/// The keys of a file, newest first, at least one; all have the same role. Throws Errc::not_found when there is no such
/// file, Errc::not_permitted when users other than its owner can read it, and Errc::malformed.
std::vector<SwarmKey> read_key_file(const std::filesystem::path& file);

/// Throws Errc::not_permitted for viewers' keys, since drones need the members' key.
/// @param file  of these keys
void require_members(const std::vector<SwarmKey>& keys, const std::filesystem::path& file);

/// Throws Errc::not_permitted when a drone would listen at a port without a key.
/// @param file  the drone's key file; empty: none
/// @param subject  the beginning of the error's text: "--listen tcp://0.0.0.0: "
/// @param insecure  the option that permits it: "--insecure"
void require_key_to_listen(const std::filesystem::path& file, const std::string& subject, const std::string& insecure);

enum class KeyFileMode { fresh, replace };
/// Writes the file atomically with mode 0600, and creates its folder. Throws Errc::name_taken when a fresh file exists
/// already, and Errc::io.
void write_key_file(const std::filesystem::path& file, const std::vector<SwarmKey>& keys, KeyFileMode mode);

}  // namespace hive
