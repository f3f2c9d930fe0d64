// Finds, validates and atomically writes the file of a swarm's keys.
#include "key_derivation.hpp"
#include "os_text.hpp"

#include <hive/error.hpp>
#include <hive/json.hpp>
#include <hive/platform/whole_file.hpp>
#include <hive/transport/descriptor.hpp>
#include <hive/transport/key_ring.hpp>

#include <cstdlib>
#include <cstring>
#include <optional>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hive {
namespace fs = std::filesystem;
namespace {

using transport::Descriptor;
using transport::os_text;

constexpr std::size_t most_bytes = 16 * 1024;
constexpr std::size_t most_keys = 8;

std::optional<unsigned> hex_digit(char digit)
{
    if (digit >= '0' && digit <= '9')
        return digit - '0';
    if (digit >= 'a' && digit <= 'f')
        return digit - 'a' + 10;
    return std::nullopt;
}

SwarmKey::Secret secret_from(const std::string& text)
{
    SwarmKey::Secret secret{};
    if (text.size() != 2 * secret.size())
        throw Error(Errc::malformed, "a secret must have 64 hexadecimal digits");
    for (std::size_t i = 0; i < secret.size(); ++i) {
        const auto high = hex_digit(text[2 * i]), low = hex_digit(text[2 * i + 1]);
        if (!high || !low)
            throw Error(Errc::malformed, "a secret must have 64 hexadecimal digits");
        secret[i] = static_cast<unsigned char>(*high * 16 + *low);
    }
    return secret;
}

std::string id_from(const Fields& fields, Role role, const SwarmKey::Secret& secret)
{
    auto id = fields.text("id");
    if (id.size() != 16 || id.find_first_not_of("0123456789abcdef") != std::string::npos)
        throw Error(Errc::malformed, "an id must have 16 hexadecimal digits");
    if (role == Role::member && id != transport::id_of(secret))
        throw Error(Errc::malformed, "the id " + id + " is not that of its secret");
    return id;
}

Role role_from(const std::string& text)
{
    for (const auto role : {Role::member, Role::viewer})
        if (text == token(role))
            return role;
    throw Error(Errc::malformed, "the role must be member or viewer");
}

std::vector<SwarmKey> keys_from(const Json& object)
{
    const Fields fields(object, "a key file");
    if (fields.integer("hive_key", 0, max_json_integer) != 1)
        throw Error(Errc::malformed, "it is of a later version of Hive");
    const auto role = role_from(fields.text("role"));
    std::vector<SwarmKey> keys;
    for (const auto& item : fields.array("keys")) {
        const Fields key(item, "a key");
        const auto secret = secret_from(key.text("secret"));
        keys.push_back({.id = id_from(key, role, secret),
                        .role = role,
                        .secret = secret,
                        .created_s = key.integer_or("created", 0, max_json_integer, 0),
                        .until_s = key.integer_or("until", 0, max_json_integer, 0)});
    }
    if (keys.empty() || keys.size() > most_keys)
        throw Error(Errc::malformed, "it must have 1 to " + std::to_string(most_keys) + " keys");
    return keys;
}

Json to_json(const std::vector<SwarmKey>& keys)
{
    Json list = Json::array();
    for (const auto& key : keys) {
        Json row{{"id", key.id},
                 {"created", key.created_s},
                 {"secret", transport::hex(key.secret.data(), key.secret.size())}};
        if (key.until_s != 0)
            row["until"] = key.until_s;
        list.push_back(std::move(row));
    }
    return {{"hive_key", 1}, {"role", token(keys.front().role)}, {"keys", std::move(list)}};
}

Descriptor open_regular(const fs::path& file)
{
    Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!opened && (errno == ENOENT || errno == ENOTDIR))
        throw Error(Errc::not_found, "there is no swarm key at " + file.string(),
                    "make one: hivectl key new; or copy the swarm's from a machine that has it: scp HOST:"
                    ".config/hive/swarm.key "
                        + file.string());
    struct stat info {};
    if (!opened || ::fstat(opened.get(), &info) != 0)
        throw Error(Errc::io, "cannot read the swarm key " + file.string() + ": " + os_text(errno));
    if (!S_ISREG(info.st_mode))
        throw Error(Errc::malformed, file.string() + " is not a swarm key: it is not a file");
    return opened;
}

/// Only for a key file: the advice must not change the mode of any other file.
void require_private(const Descriptor& opened, const fs::path& file)
{
    struct stat info {};
    if (::fstat(opened.get(), &info) != 0)
        throw Error(Errc::io, "cannot read the swarm key " + file.string() + ": " + os_text(errno));
    // A file of root that only its group reads is what a service manager makes for the group of the drone.
    const bool of_root = info.st_uid == 0 && ::geteuid() != 0;
    if (info.st_uid != ::geteuid() && !of_root)
        throw Error(Errc::not_permitted, "the swarm key " + file.string() + " belongs to another user",
                    "make a copy of your own");
    if ((info.st_mode & (of_root ? 037 : 077)) != 0)
        throw Error(Errc::not_permitted, "others can read the swarm key " + file.string(),
                    std::string("close it: chmod ") + (of_root ? "640 " : "600 ") + file.string());
}

std::string text_of(const Descriptor& opened, const fs::path& file)
{
    std::string text(most_bytes + 1, '\0');
    std::size_t size = 0;
    while (size < text.size()) {
        const auto bytes = ::read(opened.get(), text.data() + size, text.size() - size);
        if (bytes < 0 && errno == EINTR)
            continue;
        if (bytes < 0)
            throw Error(Errc::io, "cannot read the swarm key " + file.string() + ": " + os_text(errno));
        if (bytes == 0)
            break;
        size += static_cast<std::size_t>(bytes);
    }
    text.resize(size);
    return text;
}

std::string variable(const char* name) { return std::getenv(name) ? std::getenv(name) : ""; }

}  // namespace

bool key_file_is_named()
{
    const auto named = variable("HIVE_KEY");
    return !named.empty() && named != "none";
}

fs::path default_key_file()
{
    if (const auto named = variable("HIVE_KEY"); !named.empty())
        return named == "none" ? fs::path() : fs::path(named);
    if (const auto config = variable("XDG_CONFIG_HOME"); !config.empty())
        return fs::path(config) / "hive" / "swarm.key";
    if (const auto home = variable("HOME"); !home.empty())
        return fs::path(home) / ".config" / "hive" / "swarm.key";
    return {};
}

void require_members(const std::vector<SwarmKey>& keys, const fs::path& file)
{
    if (keys.front().role != Role::member)
        throw Error(Errc::not_permitted, file.string() + " is a viewers' key; drones need the members' key",
                    "copy the members' key here");
}

void require_key_to_listen(const fs::path& file, const std::string& subject, const std::string& insecure)
try {
    if (file.empty())
        throw Error(Errc::not_found, "there is no swarm key", "make one: hivectl key new");
    require_members(transport::KeyRing(file, true).own(), file);
} catch (const Error& error) {
    throw Error(Errc::not_permitted, subject + "anyone could control the drone through this port, and " + error.what(),
                error.advice() + "; or, on a network that you trust wholly, add " + insecure);
}

std::vector<SwarmKey> read_key_file(const fs::path& file)
{
    const auto opened = open_regular(file);
    const auto text = text_of(opened, file);
    std::vector<SwarmKey> keys;
    try {
        keys = keys_from(parse_json(text, {.bytes = most_bytes, .depth = 4, .keys = 16, .string_bytes = 256}));
    } catch (const Error& error) {
        throw Error(Errc::malformed, file.string() + " is not a swarm key: " + error.what());
    }
    require_private(opened, file);
    return keys;
}

void write_key_file(const fs::path& file, const std::vector<SwarmKey>& keys, KeyFileMode mode)
{
    std::error_code problem;
    if (file.has_parent_path() && !fs::exists(file.parent_path(), problem)) {
        fs::create_directories(file.parent_path(), problem);
        if (!problem)
            fs::permissions(file.parent_path(), fs::perms::owner_all, problem);
        if (problem)
            throw Error(Errc::io, "cannot make " + file.parent_path().string() + ": " + problem.message());
    }
    const auto failed = platform::write_whole(file, to_json(keys).dump(2) + "\n",
                                              {.replaces = mode == KeyFileMode::replace, .durable = true});
    if (failed == std::errc::file_exists)
        throw Error(Errc::name_taken, "there is a swarm key already: " + file.string(),
                    "rotate it: hivectl key rotate; or use another file");
    if (failed)
        throw Error(Errc::io, "cannot write " + file.string() + ": " + failed.message());
}

}  // namespace hive
