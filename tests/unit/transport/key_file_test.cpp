// The file of a swarm's keys, and what is made of a key.
#include "key_derivation.hpp"

#include <hive/error.hpp>
#include <hive/transport/key.hpp>
#include <hive/transport/key_ring.hpp>

#include <doctest/doctest.h>

#include <cstdlib>
#include <fstream>
#include <set>

#include <grp.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

namespace fs = std::filesystem;
using hive::Errc;
using hive::KeyFileMode;
using hive::Role;
using hive::SwarmKey;

class Folder {
public:
    Folder()
    {
        std::string name = (fs::temp_directory_path() / "hive-keys-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        at_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { fs::remove_all(at_); }
    [[nodiscard]] fs::path file() const { return at_ / "new" / "swarm.key"; }
    [[nodiscard]] fs::path write(const std::string& text) const
    {
        const auto file = at_ / "given.key";
        fs::remove(file);
        std::ofstream(file) << text;
        REQUIRE(::chmod(file.c_str(), 0600) == 0);
        return file;
    }

private:
    fs::path at_;
};

std::string zeros(std::size_t count) { return std::string(count, '0'); }

Errc code_of(const fs::path& file)
try {
    hive::read_key_file(file);
    FAIL("it was read");
    return {};
} catch (const hive::Error& error) {
    return error.code();
}

}  // namespace

TEST_CASE("key file: what was written is read again, and only its owner may read it")
{
    const Folder folder;
    auto old = hive::new_swarm_key(1'700'000'000);
    old.until_s = 4'000'000'000;
    const auto fresh = hive::new_swarm_key(1'700'000'001);
    hive::write_key_file(folder.file(), {fresh, old}, KeyFileMode::fresh);
    struct stat info {};
    REQUIRE(::stat(folder.file().c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0600);
    CHECK(std::distance(fs::directory_iterator(folder.file().parent_path()), fs::directory_iterator()) == 1);
    const auto keys = hive::read_key_file(folder.file());
    REQUIRE(keys.size() == 2);
    CHECK(keys[0].id == fresh.id);
    CHECK(keys[0].secret == fresh.secret);
    CHECK(keys[0].role == Role::member);
    CHECK(keys[0].created_s == 1'700'000'001);
    CHECK(keys[0].until_s == 0);
    CHECK(keys[1].id == old.id);
    CHECK(keys[1].until_s == 4'000'000'000);
}

TEST_CASE("key file: one that others may read is refused with the command that closes it")
{
    const Folder folder;
    hive::write_key_file(folder.file(), {hive::new_swarm_key(1)}, KeyFileMode::fresh);
    for (const int mode : {0640, 0604, 0620, 0610}) {
        REQUIRE(::chmod(folder.file().c_str(), static_cast<mode_t>(mode)) == 0);
        CHECK(code_of(folder.file()) == Errc::not_permitted);
    }
    try {
        hive::read_key_file(folder.file());
    } catch (const hive::Error& error) {
        CHECK(error.advice().find("chmod 600 " + folder.file().string()) != std::string::npos);
    }
    REQUIRE(::chmod(folder.file().c_str(), 0400) == 0);
    CHECK(hive::read_key_file(folder.file()).size() == 1);
}

TEST_CASE("key file: another user reads one of root, if only its group may, as a pod has it"
          * doctest::skip(::geteuid() != 0))  // only root can become the other user
{
    const Folder folder;
    hive::write_key_file(folder.file(), {hive::new_swarm_key(1)}, KeyFileMode::fresh);
    constexpr unsigned other = 65532;
    for (const auto& part : {folder.file().parent_path(), folder.file().parent_path().parent_path()})
        REQUIRE(::chmod(part.c_str(), 0755) == 0);
    const auto read_by_other = [&](unsigned owner, int mode) {
        REQUIRE(::chown(folder.file().c_str(), owner, other) == 0);
        REQUIRE(::chmod(folder.file().c_str(), static_cast<mode_t>(mode)) == 0);
        const auto child = ::fork();
        if (child == 0) {
            if (::setgroups(0, nullptr) != 0 || ::setgid(other) != 0 || ::setuid(other) != 0)
                ::_exit(2);
            try {
                hive::read_key_file(folder.file());
                ::_exit(0);
            } catch (...) {
                ::_exit(1);
            }
        }
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    };
    CHECK(read_by_other(0, 0440) == 0);
    CHECK(read_by_other(0, 0640) == 0);
    CHECK(read_by_other(other, 0400) == 0);
    for (const int mode : {0460, 0450, 0444, 0442, 0441})
        CHECK(read_by_other(0, mode) == 1);
    CHECK(read_by_other(other, 0440) == 1);
    CHECK(read_by_other(1000, 0440) == 1);
}

TEST_CASE("key file: nobody is told to close a file that is no key")
{
    const Folder folder;
    fs::create_directories(folder.file().parent_path());
    std::ofstream(folder.file()) << "root:x:0:0\n";
    REQUIRE(::chmod(folder.file().c_str(), 0644) == 0);
    try {
        hive::read_key_file(folder.file());
        FAIL("it was read");
    } catch (const hive::Error& error) {
        CHECK(error.code() == Errc::malformed);
        CHECK(error.advice().find("chmod") == std::string::npos);
    }
}

TEST_CASE("key file: a fresh one is never written over another")
{
    const Folder folder;
    const auto key = hive::new_swarm_key(1);
    hive::write_key_file(folder.file(), {key}, KeyFileMode::fresh);
    CHECK_THROWS_AS(hive::write_key_file(folder.file(), {hive::new_swarm_key(2)}, KeyFileMode::fresh), hive::Error);
    CHECK(hive::read_key_file(folder.file()).at(0).id == key.id);
    hive::write_key_file(folder.file(), {hive::new_swarm_key(2)}, KeyFileMode::replace);
    CHECK(hive::read_key_file(folder.file()).at(0).id != key.id);
}

TEST_CASE("key file: what is none is refused, with what is wrong")
{
    const Folder folder;
    CHECK(code_of(folder.file()) == Errc::not_found);
    const auto viewer =
        R"({"hive_key":1,"role":"viewer","keys":[{"id":")" + zeros(16) + R"(","secret":")" + zeros(64) + R"("}]})";
    CHECK(hive::read_key_file(folder.write(viewer)).at(0).role == Role::viewer);
    auto member = viewer;
    member.replace(member.find("viewer"), 6, "member");  // the id is not that of the secret
    const std::string owner = std::string(viewer).replace(viewer.find("viewer"), 6, "owner");
    const std::string later = std::string(viewer).replace(viewer.find(":1"), 2, ":2");
    const std::string short_secret = std::string(viewer).replace(viewer.find(zeros(64)), 1, "");
    const std::string no_digits = std::string(viewer).replace(viewer.find(zeros(64)), 1, "G");
    for (const auto& text : std::vector<std::string>{"", "secret", "{}", "[]", member, owner, later, short_secret,
                                                     no_digits, R"({"hive_key":1,"role":"viewer","keys":[]})",
                                                     viewer + viewer, std::string(1 << 20, ' ')})
        CHECK(code_of(folder.write(text)) == Errc::malformed);
    CHECK(code_of(folder.file().parent_path().parent_path()) != Errc::io);
}

TEST_CASE("keys: viewers have the id of the members and another secret, and each use has its own")
{
    const auto members = hive::new_swarm_key(1), others = hive::new_swarm_key(1);
    const auto viewers = hive::viewers_key(members);
    CHECK(viewers.id == members.id);
    CHECK(viewers.role == Role::viewer);
    CHECK(members.id != others.id);
    const std::set<SwarmKey::Secret> secrets{members.secret, viewers.secret, others.secret,
                                             hive::transport::tls_secret(members),
                                             hive::transport::tls_secret(viewers)};
    CHECK(secrets.size() == 5);
    CHECK(hive::viewers_key(members).secret == viewers.secret);
    CHECK_THROWS_AS(hive::viewers_key(viewers), hive::Error);
}

TEST_CASE("keys: derivation is HKDF-SHA256 as RFC 5869 has it, so that other languages can do it")
{
    // HKDF with an empty salt, the secret 00 01 02 ... 1f, the info "hive id v1"; by Python's hmac.
    SwarmKey::Secret secret{};
    for (std::size_t i = 0; i < secret.size(); ++i)
        secret[i] = static_cast<unsigned char>(i);
    CHECK(hive::transport::id_of(secret) == "85def986b32f5d10");
}

TEST_CASE("key ring: it follows its file, keeps what it has while the file is unreadable, and drops what has ended")
{
    const Folder folder;
    hive::transport::KeyRing ring(folder.file());
    CHECK_THROWS_AS(ring.own(), hive::Error);
    const auto first = hive::new_swarm_key(1);
    hive::write_key_file(folder.file(), {first}, KeyFileMode::fresh);
    CHECK(ring.own().at(0).id == first.id);
    CHECK(ring.accepted().size() == 2);
    CHECK(ring.accepts(first.id, Role::viewer));
    CHECK(ring.offers(first.id, Role::member));
    CHECK_FALSE(ring.offers(first.id, Role::viewer));
    REQUIRE(::chmod(folder.file().c_str(), 0644) == 0);
    CHECK(ring.accepts(first.id, Role::member));
    CHECK_FALSE(ring.trouble().empty());
    const auto second = hive::new_swarm_key(2);
    auto ended = first;
    ended.until_s = 1;
    hive::write_key_file(folder.file(), {second, ended}, KeyFileMode::replace);
    CHECK(ring.own().size() == 1);
    CHECK(ring.trouble().empty());
    CHECK(ring.accepts(second.id, Role::member));
    CHECK_FALSE(ring.accepts(first.id, Role::member));
    CHECK_FALSE(ring.accepts(first.id, Role::viewer));
    hive::write_key_file(folder.file(), {ended}, KeyFileMode::replace);
    CHECK_THROWS_AS(ring.own(), hive::Error);
    CHECK_FALSE(ring.accepts(second.id, Role::member));
    CHECK_FALSE(ring.offers(second.id, Role::member));
}

TEST_CASE(
    "key: what is announced of a key is known by members and viewers alike, and is neither the id nor of another key")
{
    const auto key = hive::new_swarm_key(1'700'000'000), other = hive::new_swarm_key(1'700'000'000);
    const auto fingerprint = hive::announced_fingerprint(key);
    CHECK(fingerprint.size() == 32);
    CHECK(fingerprint == hive::announced_fingerprint(hive::viewers_key(key)));
    CHECK(fingerprint != hive::announced_fingerprint(other));
    CHECK(fingerprint.find(key.id) == std::string::npos);
    CHECK(hive::announcement_proof(key, "a") != hive::announcement_proof(hive::viewers_key(key), "a"));
    std::set<std::string> all{fingerprint};
    for (const auto* text : {"", "a", "b"}) {
        all.insert(hive::announcement_proof(key, text));
        all.insert(hive::announcement_proof(other, text));
    }
    CHECK(all.size() == 7);
}
