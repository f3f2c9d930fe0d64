// The key of a swarm and its file: who has it may come in over TCP (libhive/docs/security.md).
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

    std::string id;            ///< 16 hexadecimal digits, no secret: the same for members and viewers of one key
    Role role = Role::member;  ///< or viewer
    Secret secret{};
    std::int64_t created_s = 0;  ///< seconds since 1970
    std::int64_t until_s = 0;    ///< holds until then, in seconds since 1970; 0: without end
};

/// A fresh one for members, of random bytes.
SwarmKey new_swarm_key(std::int64_t now_s);
/// What viewers get: made of the members' key, which cannot be told from it.
SwarmKey viewers_key(const SwarmKey& members);
/// Does it hold at that time?
inline bool holds(const SwarmKey& key, std::int64_t now_s) { return key.until_s == 0 || now_s < key.until_s; }

/// What a drone announces on the local network to be known by holders of its key, members and viewers alike: made of
/// the viewers' key under a use of its own, so it helps nobody to guess a key, nor to connect it with the key's id.
std::string announced_fingerprint(const SwarmKey& key);
/// That a text was announced by a holder of the key; different for each text, and for members and viewers: who can
/// check one could have made it.
std::string announcement_proof(const SwarmKey& key, std::string_view text);

/// Where the keys of this user are: $HIVE_KEY, or $XDG_CONFIG_HOME/hive/swarm.key, or ~/.config/hive/swarm.key. Empty
/// when HIVE_KEY is "none": then there is no key, whatever lies there.
std::filesystem::path default_key_file();
/// Did the user name that file, so that there has to be a key?
bool key_file_is_named();

/// The keys of a file, newest first, at least one; all have the same role. Throws Errc::not_found when there is no such
/// file, Errc::not_permitted when others than its owner may read it, and Errc::malformed.
std::vector<SwarmKey> read_key_file(const std::filesystem::path& file);

/// A drone lets in only peers that have the members' key. Throws Errc::not_permitted for the viewers'.
/// @param file  of these keys
void require_members(const std::vector<SwarmKey>& keys, const std::filesystem::path& file);

/// Throws Errc::not_permitted when a drone that listens at a port would have no key to ask its peers for.
/// @param file      of its keys; empty: it has none
/// @param subject   what is said before the text: "--listen tcp://0.0.0.0: "
/// @param insecure  how to say that it is to listen even so: "--insecure"
void require_key_to_listen(const std::filesystem::path& file, const std::string& subject, const std::string& insecure);

enum class KeyFileMode { fresh, replace };
/// Writes the file with mode 0600, at once as a whole, and makes its folder. Throws Errc::name_taken when a fresh one
/// is there already, and Errc::io.
void write_key_file(const std::filesystem::path& file, const std::vector<SwarmKey>& keys, KeyFileMode mode);

}  // namespace hive
