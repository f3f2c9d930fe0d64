// The lock of a folder: exclusive, waited for, and given up in time.
#include <hive/error.hpp>
#include <hive/transport/folder_lock.hpp>

#include <doctest/doctest.h>

#include <atomic>
#include <cstdlib>
#include <optional>
#include <thread>
#include <vector>

namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using hive::Errc;
using hive::transport::FolderLock;

class FreshFolder {
public:
    FreshFolder()
    {
        std::string name = (fs::temp_directory_path() / "hive-lock-XXXXXX").string();
        REQUIRE(::mkdtemp(name.data()) != nullptr);
        path = name;
    }
    FreshFolder(const FreshFolder&) = delete;
    FreshFolder& operator=(const FreshFolder&) = delete;
    ~FreshFolder() { fs::remove_all(path); }

    fs::path path;
};

std::optional<Errc> problem_of(const fs::path& folder, std::chrono::milliseconds timeout)
try {
    const FolderLock lock(folder, timeout);
    return std::nullopt;
} catch (const hive::Error& error) {
    return error.code();
}

}  // namespace

TEST_CASE("folder lock: one holder at a time, and every waiter gets it")
{
    const FreshFolder folder;
    constexpr int threads = 8, times = 50;
    std::atomic<int> inside = 0, most_inside = 0, entered = 0;
    std::vector<std::thread> all;
    for (int i = 0; i < threads; ++i)
        all.emplace_back([&] {
            for (int time = 0; time < times; ++time) {
                const FolderLock lock(folder.path, 60s);
                const int present = ++inside;
                most_inside = std::max(most_inside.load(), present);
                ++entered;
                std::this_thread::yield();
                --inside;
            }
        });
    for (auto& thread : all)
        thread.join();
    CHECK(most_inside == 1);
    CHECK(entered == threads * times);
}

TEST_CASE("folder lock: a waiter gives up in time, and what it gets too late is free again")
{
    const FreshFolder folder;
    std::optional<FolderLock> holder(std::in_place, folder.path);
    const auto start = std::chrono::steady_clock::now();
    CHECK(problem_of(folder.path, 20ms) == Errc::timeout);
    CHECK(std::chrono::steady_clock::now() - start >= 20ms);
    CHECK(problem_of(folder.path, 0ms) == Errc::timeout);
    holder.reset();
    CHECK_FALSE(problem_of(folder.path, 60s));
}

TEST_CASE("folder lock: without the folder there is no lock")
{
    const FreshFolder folder;
    CHECK(problem_of(folder.path / "absent", 1s) == Errc::io);
}
