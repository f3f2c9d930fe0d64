// hivectl key: creates, rotates and shows the swarm's key file, and derives a read-only key for viewers.
#include "../verbs.hpp"
#include "words/format.hpp"

#include <hive/remote.hpp>
#include <hive/transport/folder_lock.hpp>
#include <hive/transport/key.hpp>

#include <algorithm>
#include <chrono>

namespace hivectl::key_verb {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::string action, file, output;
    double keep_s = 24 * 3600;
    bool replace = false;
};

std::int64_t now_s()
{
    return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

fs::path file_of(const Options& options)
{
    const auto file = options.file.empty() ? hive::default_key_file() : fs::path(options.file);
    if (file.empty())
        throw hive::Error(hive::Errc::invalid_argument, "HIVE_KEY is \"none\", and no --file is given");
    return fs::absolute(file);
}

std::string handed_over(const fs::path& file) { return hive::copy_of_key(file, "HOST"); }

int told(const hive::SwarmKey& key, const fs::path& file, const std::string& next, const Session& session)
{
    const Row row{{"id", key.id}, {"role", hive::token(key.role)}, {"file", file.string()}};
    write_out(session.json ? row.json() + "\n" : file.string() + "\n");
    complain("key", next);
    return exit_code::done;
}

int make(const Options& options, const Session& session)
{
    const auto file = file_of(options);
    const auto key = hive::new_swarm_key(now_s());
    hive::write_key_file(file, {key}, hive::KeyFileMode::fresh);
    return told(key, file, "the key " + key.id + " lets machines join the swarm; copy it: " + handed_over(file),
                session);
}

std::vector<hive::SwarmKey> members_keys(const fs::path& file)
{
    auto keys = hive::read_key_file(file);
    if (keys.front().role != hive::Role::member)
        throw hive::Error(hive::Errc::not_permitted, file.string() + " is a viewers' key",
                          "do this on a machine that has the members' key");
    std::erase_if(keys, [now = now_s()](const hive::SwarmKey& key) { return !hive::holds(key, now); });
    if (keys.empty())
        throw hive::Error(hive::Errc::not_permitted, "every key in " + file.string() + " has expired",
                          "copy the current key from another machine");
    return keys;
}

int view(const Options& options, const Session& session)
{
    const auto file = file_of(options);
    const auto target =
        fs::absolute(options.output.empty() ? file.parent_path() / "viewer.key" : fs::path(options.output));
    std::vector<hive::SwarmKey> keys;
    for (const auto& key : members_keys(file))
        keys.push_back(hive::viewers_key(key));
    hive::write_key_file(target, keys, options.replace ? hive::KeyFileMode::replace : hive::KeyFileMode::fresh);
    return told(keys.front(), target, "holders of this key can only read and receive; copy it: " + handed_over(target),
                session);
}

/// The new key comes first; the current ones stay valid for a while, so that machines can be updated one by one.
int rotate(const Options& options, const Session& session)
{
    const auto file = file_of(options);
    static_cast<void>(members_keys(file));  // a missing key is reported, and not the missing folder
    const hive::transport::FolderLock lock(file.parent_path());
    const auto until = now_s() + static_cast<std::int64_t>(options.keep_s);
    auto keys = members_keys(file);
    for (auto& key : keys)
        key.until_s = key.until_s == 0 ? until : std::min(key.until_s, until);
    std::erase_if(keys, [](const hive::SwarmKey& key) { return !hive::holds(key, now_s()); });
    keys.insert(keys.begin(), hive::new_swarm_key(now_s()));
    keys.resize(std::min<std::size_t>(keys.size(), 8));
    hive::write_key_file(file, keys, hive::KeyFileMode::replace);
    const auto old = keys.size() == 1 ? "the old key has expired"
                                      : "the old key holds for "
                                            + duration_text(static_cast<std::int64_t>(options.keep_s * 1e6)) + " more";
    return told(keys.front(), file, old + "; copy the new key meanwhile: " + handed_over(file), session);
}

int show(const Options& options, const Session& session)
{
    const auto file = file_of(options);
    std::vector<Row> rows;
    for (const auto& key : hive::read_key_file(file)) {
        const auto left_s = key.until_s - now_s();
        Row& row = rows.emplace_back(Row{{"id", key.id},
                                         {"role", hive::token(key.role)},
                                         {"created_us", key.created_s * 1'000'000},
                                         {"file", file.string()}});
        if (key.until_s != 0)
            row.add("holds_for_us", std::max<std::int64_t>(left_s, 0) * 1'000'000);
    }
    print_rows(session.form(),
               {{"KEY", "id"},
                {"ROLE", "role"},
                {"CREATED", "created_us", as_time},
                {"HOLDS FOR", "holds_for_us", as_duration, nothing},
                {"FILE", "file"}},
               rows);
    return exit_code::done;
}

int run(const Options& options, Session& session)
{
    if (options.action == "new")
        return make(options, session);
    if (options.action == "view")
        return view(options, session);
    return options.action == "rotate" ? rotate(options, session) : show(options, session);
}

void declare(CommandLine& line, Options& options)
{
    line.option("ACTION", options.action,
                "new: create the swarm's key; view: derive a read-only key; rotate: replace the key; show: list the "
                "keys without their secrets")
        .required()
        .one_of({"new", "view", "rotate", "show"});
    line.option("--file", options.file, "the key file (default: $HIVE_KEY, or ~/.config/hive/swarm.key)")
        .type_name("FILE");
    line.option("-o,--output", options.output, "view: output file (default: viewer.key next to the swarm key)")
        .type_name("FILE");
    line.flag("--replace", options.replace, "view: replace an existing file");
    line.option("--keep", options.keep_s, "rotate: how long the old key stays valid (default: 86400, a day)")
        .type_name("SECONDS")
        .seconds(0);
}

}  // namespace

Verb verb()
{
    return {.name = "key",
            .group = "on several machines",
            .usage = "new|view|rotate|show [options]",
            .summary = "Creates, rotates and shows the key that machines need to join",
            .details = "Key holders can connect over TCP (start --listen) and do all that hivectl can do; viewers can "
                       "read and receive. Prints the file that was written; copy it to the same path on the other "
                       "machines. Running drones notice a new file within a second.",
            .examples = "hivectl key new  once for a swarm\n"
                        "hivectl key show\n"
                        "hivectl key view  for viewers\n"
                        "hivectl key rotate --keep 3600  the old key expires after an hour",
            .timeout = "has no effect here",
            .table = true,
            .operands = {Operand::other},
            .declare = with(declare, run)};
}

}  // namespace hivectl::key_verb
