// What the log makes of texts that came from elsewhere.
#include "bounded_log.hpp"

#include <doctest/doctest.h>
#include <spdlog/logger.h>

#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace {

/// What is written to standard error while `write` runs.
std::string errors_of(const std::function<void()>& write)
{
    std::string path = (std::filesystem::temp_directory_path() / "hive-log-XXXXXX").string();
    const int file = ::mkstemp(path.data()), before = ::dup(STDERR_FILENO);
    REQUIRE(file >= 0);
    ::dup2(file, STDERR_FILENO);
    write();
    ::dup2(before, STDERR_FILENO);
    ::close(before);
    ::close(file);
    std::ifstream written(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(written), {}};
    ::unlink(path.c_str());
    return text;
}

}  // namespace

TEST_CASE("log: whatever a text holds, it is one line, not too long, and no order to a terminal")
{
    spdlog::logger log("test", std::make_shared<hive::BoundedLog>("nowhere.log"));
    log.set_pattern("%v");
    CHECK(errors_of([&] { log.info("plain \xC3\xA4 text"); }) == "plain \xC3\xA4 text\n");
    CHECK(errors_of([&] { log.info("a\x1b]0;owned\x07\n2026-01-01 info forged\xC2\x9B"); })
          == "a\\x1b]0;owned\\x07\\n2026-01-01 info forged\\x9b\n");
    const auto endless = errors_of([&] { log.info(std::string(60'000, 'x')); });
    CHECK(endless.size() == 4001);
    CHECK(endless.ends_with("\xE2\x80\xA6\n"));
}
