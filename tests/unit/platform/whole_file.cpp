// Whole files: content, mode, and that a failure leaves everything as it was.
#include <hive/platform/whole_file.hpp>

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <sys/resource.h>
#include <sys/stat.h>

using hive::platform::write_whole;
namespace fs = std::filesystem;

namespace {

class Folder {
public:
    Folder()
    {
        std::string name = (fs::temp_directory_path() / "hive-whole-XXXXXX").string();
        if (!::mkdtemp(name.data()))
            throw std::runtime_error("cannot make a folder");
        path = name;
    }
    ~Folder() { fs::remove_all(path); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    [[nodiscard]] auto files() const { return std::distance(fs::directory_iterator(path), fs::directory_iterator()); }
    fs::path path;
};

/// Files may have at most 10 bytes meanwhile.
class SmallFiles {
public:
    SmallFiles() : handler_(std::signal(SIGXFSZ, SIG_IGN))
    {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit small{10, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &small);
    }
    ~SmallFiles()
    {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    SmallFiles(const SmallFiles&) = delete;
    SmallFiles& operator=(const SmallFiles&) = delete;

private:
    void (*handler_)(int);
    rlimit before_{};
};

std::string text_of(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

unsigned mode_of(const fs::path& file)
{
    struct stat info {};
    REQUIRE(::stat(file.c_str(), &info) == 0);
    return info.st_mode & 0777;
}

}  // namespace

TEST_CASE("whole file: it has its bytes and its mode, and nothing else remains")
{
    const Folder folder;
    const auto file = folder.path / "key";
    const std::string bytes("a\0b\n", 4);
    CHECK(!write_whole(file, bytes, {.durable = true}));
    CHECK(text_of(file) == bytes);
    CHECK(mode_of(file) == 0600);
    const auto before = ::umask(022);
    CHECK(!write_whole(file, "shorter", {.mode = 0666}));
    ::umask(before);
    CHECK(text_of(file) == "shorter");
    CHECK(mode_of(file) == 0644);
    CHECK(folder.files() == 1);
}

TEST_CASE("whole file: one that must not replace another leaves it")
{
    const Folder folder;
    const auto file = folder.path / "token";
    CHECK(!write_whole(file, "first", {.replaces = false}));
    CHECK(write_whole(file, "second", {.replaces = false}) == std::errc::file_exists);
    CHECK(text_of(file) == "first");
    CHECK(folder.files() == 1);
}

TEST_CASE("whole file: when the bytes find no room, the old file stays and no part of the new one")
{
    const Folder folder;
    const auto file = folder.path / "now.jpg";
    REQUIRE(!write_whole(file, "old"));
    {
        const SmallFiles small;
        CHECK(write_whole(file, "more than ten bytes") == std::errc::file_too_large);
    }
    CHECK(text_of(file) == "old");
    CHECK(folder.files() == 1);
    CHECK(write_whole(folder.path / "nowhere/now.jpg", "x") == std::errc::no_such_file_or_directory);
}

TEST_CASE("whole file: what lies under the other name is not written through")
{
    const Folder folder;
    const auto file = folder.path / "key", other = folder.path / "other";
    std::ofstream(other) << "untouched";
    fs::create_symlink(other, file.string() + "." + std::to_string(hive::platform::own_pid()) + ".new");
    CHECK(!write_whole(file, "secret"));
    CHECK(text_of(file) == "secret");
    CHECK(text_of(other) == "untouched");
    CHECK(folder.files() == 2);
}
