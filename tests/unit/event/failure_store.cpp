// What drones failed at, in files: numbers, bounds, modes.
#include "fixtures.hpp"

#include <hive/error.hpp>
#include <hive/event/failure_store.hpp>

#include <cstdlib>
#include <doctest/doctest.h>
#include <fcntl.h>
#include <fstream>
#include <sys/file.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace hive::event {
namespace {

class Folder {
public:
    Folder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "hive-store-XXXXXX").string();
        REQUIRE(::mkdtemp(pattern.data()));
        path_ = pattern;
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] Home home() const { return Home(path_); }
    [[nodiscard]] std::filesystem::path kept() const { return path_ / FailureStore::folder; }

private:
    std::filesystem::path path_;
};

KeptFailure failure(const std::string& drone, std::int64_t sequence, std::int64_t run = 0, std::size_t bytes = 10)
{
    Event event = emission(sequence, false, bytes)->event();
    event.input = "image";
    return {.drone = drone, .time_us = 1000 + sequence, .run = run, .code = "failed", .text = "no", .inputs = {event}};
}

std::vector<std::int64_t> numbers(const FailureStore& store, const std::string& drone)
{
    std::vector<std::int64_t> all;
    for (const auto& each : store.read(drone, false))
        all.push_back(each.number);
    return all;
}

}  // namespace

TEST_CASE("failure store: what was kept is read, with or without bodies")
{
    const Folder folder;
    const FailureStore store(folder.home());
    CHECK(store.read("face", true).empty());
    CHECK(store.keep(failure("face", 7)) == 1);
    const auto all = store.read("face", true);
    REQUIRE(all.size() == 1);
    CHECK(all[0].time_us == 1007);
    CHECK(all[0].code == "failed");
    CHECK(all[0].text == "no");
    REQUIRE(all[0].inputs.size() == 1);
    CHECK(all[0].inputs[0].input == "image");
    CHECK(all[0].inputs[0].identity.sequence == 7);
    CHECK(all[0].inputs[0].body.size() == 10);
    CHECK(all[0].inputs[0].body.data()[9] == 7);
    const auto headers = store.read("face", false);
    CHECK(headers[0].inputs[0].body.empty());
    CHECK(headers[0].inputs[0].size == 10);
    CHECK(store.drones() == std::vector<std::string>{"face"});
}

TEST_CASE("failure store: a fifth failure removes the oldest of this drone, and numbers go on")
{
    const Folder folder;
    const FailureStore store(folder.home());
    store.keep(failure("other", 1));
    for (int i = 1; i <= 5; ++i)
        CHECK(store.keep(failure("face", i)) == i);
    CHECK(numbers(store, "face") == std::vector<std::int64_t>{2, 3, 4, 5});
    CHECK(numbers(store, "other") == std::vector<std::int64_t>{1});
}

TEST_CASE("failure store: what several senders keep of one death is one failure")
{
    const Folder folder;
    const FailureStore store(folder.home());
    CHECK(store.keep(failure("face", 1), "") == 1);
    CHECK(store.keep(failure("face", 2, 99), "left.image,left") == 2);
    CHECK(store.keep(failure("face", 3, 99), "right.image,right") == 2);
    CHECK(store.keep(failure("face", 4, 99), "right.image,right") == 2);  // told again: the newer holds
    CHECK(store.keep(failure("face", 5, 100), "left.image,left") == 3);
    const auto all = store.read("face", true);
    REQUIRE(all.size() == 3);
    REQUIRE(all[1].inputs.size() == 2);
    CHECK(all[1].inputs[0].identity.sequence == 2);
    CHECK(all[1].inputs[1].identity.sequence == 4);
}

TEST_CASE("failure store: 64 MiB in all, and nothing larger")
{
    const Folder folder;
    const FailureStore store(folder.home());
    constexpr std::size_t size = 20u << 20;
    for (const auto* drone : {"a", "b", "c", "d"})
        store.keep(failure(drone, 1, 0, size));
    CHECK(store.drones() == std::vector<std::string>{"b", "c", "d"});
    CHECK(store.keep(failure("e", 1, 0, FailureStore::max_bytes + 1)) == 0);
    CHECK(store.drones().size() == 3);
}

TEST_CASE("failure store: room is made before a failure is written")
{
    const Folder folder;
    const FailureStore store(folder.home());
    std::uintmax_t most = 0;
    std::jthread watcher([&](const std::stop_token& end) {
        while (!end.stop_requested()) {
            std::uintmax_t bytes = 0;
            std::error_code gone;
            for (const auto& entry : std::filesystem::directory_iterator(folder.kept(), gone))
                if (const auto size = entry.file_size(gone); !gone)
                    bytes += size;
            most = std::max(most, bytes);
        }
    });
    for (int i = 1; i <= 8; ++i)
        CHECK(store.keep(failure("face-" + std::to_string(i), 1, 0, 20u << 20)) == 1);
    watcher.request_stop();
    watcher.join();
    CHECK(most > FailureStore::max_bytes / 2);
    CHECK(most <= FailureStore::max_bytes);
}

TEST_CASE("failure store: a process that is suspended with the lock delays others only shortly, and they say so")
{
    const Folder folder;
    const FailureStore store(folder.home());
    CHECK(store.keep(failure("face", 1)) == 1);
    const int other = ::open(folder.kept().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    REQUIRE(::flock(other, LOCK_EX) == 0);
    const auto begin = std::chrono::steady_clock::now();
    try {
        store.keep(failure("face", 2));
        FAIL("kept");
    } catch (const Error& error) {
        CHECK(error.code() == Errc::timeout);
        CHECK(std::string(error.what()).find("another process has locked ") == 0);
    }
    const auto waited = std::chrono::steady_clock::now() - begin;
    CHECK(waited >= FailureStore::max_wait);
    CHECK(waited < 20 * FailureStore::max_wait);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.kept()), {}) == 1);
    ::close(other);
    CHECK(store.keep(failure("face", 2)) == 2);
}

TEST_CASE("failure store: only its user reads, and what a writer that died has left is removed")
{
    const Folder folder;
    const FailureStore store(folder.home());
    std::filesystem::create_directory(folder.kept());
    std::filesystem::permissions(folder.kept(), std::filesystem::perms::owner_all);
    std::ofstream(folder.kept() / ".new-999999999-1") << "half of it";
    const auto old = folder.kept() / (".new-" + std::to_string(::getpid()) + "-1");  // its pid is another's by now
    std::ofstream(old) << "half of it";
    std::filesystem::last_write_time(old, std::filesystem::file_time_type::clock::now() - std::chrono::minutes(2));
    store.keep(failure("face", 1));
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder.kept())) {
        struct stat info {};
        REQUIRE(::stat(entry.path().c_str(), &info) == 0);
        CHECK((info.st_mode & 0777) == 0600);
        ++files;
    }
    CHECK(files == 1);
}

TEST_CASE("failure store: files that were changed by hand are left out")
{
    const Folder folder;
    const FailureStore store(folder.home());
    store.keep(failure("face", 1));
    store.keep(failure("face", 2));
    std::filesystem::resize_file(folder.kept() / "face,1,0,", 100);
    std::ofstream(folder.kept() / "face,3,0,") << "HIVE";
    std::ofstream(folder.kept() / "../x,9,0,") << "HIVE";
    CHECK(numbers(store, "face") == std::vector<std::int64_t>{2});
}

}  // namespace hive::event
