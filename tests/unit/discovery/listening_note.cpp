// The note of who has listened to the network of late.
#include "listening_note.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <fstream>
#include <unistd.h>

namespace hive::discovery {
namespace fs = std::filesystem;

TEST_CASE("listening note: it holds for a minute, and what is damaged or ahead of time says nothing")
{
    std::string folder = "/tmp/hv-XXXXXX";
    REQUIRE(::mkdtemp(folder.data()));
    const fs::path file = fs::path(folder) / ".announced";
    const ListeningNote note(file);
    CHECK_FALSE(note.daemon());
    note.write(4'000'000'000);
    CHECK(note.daemon() == 4'000'000'000);
    const auto written = fs::last_write_time(file);
    fs::last_write_time(file, written - std::chrono::minutes(2));
    CHECK_FALSE(note.daemon());
    fs::last_write_time(file, written + std::chrono::minutes(2));
    CHECK_FALSE(note.daemon());
    std::ofstream(file) << "nonsense";
    CHECK_FALSE(note.daemon());
    ListeningNote(fs::path(folder) / "no folder" / "note").write(1);  // says nothing, does nothing
    fs::remove_all(folder);
}

}  // namespace hive::discovery
