// Files that are cut, changed or made up: complete parts are read, errors are detected, and nothing is trusted.
#include "files.hpp"

#include <doctest/doctest.h>
#include <eventually.hpp>

#include <algorithm>
#include <limits>

using namespace record_test;
using hive::recording::Reader;

namespace {

constexpr int events = 6;

/// Where each whole event ends.
std::vector<std::size_t> ends_of(const fs::path& path)
{
    Reader reader(path);
    std::vector<std::size_t> ends;
    while (const auto record = reader.next())
        ends.push_back(record->offset + record->prefix.record_size());
    return ends;
}

std::string forged(const hive::recording::Prefix& prefix, const std::string& rest)
{
    const auto head = hive::recording::encode(prefix);
    return std::string(hive::recording::file_magic)
           + std::string(reinterpret_cast<const char*>(head.data()), head.size()) + rest;
}

}  // namespace

TEST_CASE("recording: cut at any byte, it has exactly the whole events before that")
{
    const Folder folder;
    const std::string whole = record(folder / "whole", events);
    const auto ends = ends_of(folder / "whole");
    REQUIRE(ends.size() == events);
    for (std::size_t size = hive::recording::file_magic.size(); size < whole.size(); ++size) {
        CAPTURE(size);
        write_bytes(folder / "cut", whole.substr(0, size));
        Reader reader(folder / "cut");
        const auto read = read_all(reader);
        const auto expected = std::ranges::count_if(ends, [&](std::size_t end) { return end <= size; });
        CHECK(read.damaged == 0);
        CHECK(read.problem != "");
        CHECK(reader.summary().events() == expected);
        REQUIRE(static_cast<std::ptrdiff_t>(read.texts.size()) == expected);
        for (int i = 0; i < expected; ++i) {
            CHECK(read.texts[static_cast<std::size_t>(i)] == text_of(i));
            CHECK(read.bodies[static_cast<std::size_t>(i)] == body_of(i));
        }
    }
}

TEST_CASE("recording: a byte that was changed is noticed, and costs at most what comes after it")
{
    const Folder folder;
    const std::string whole = record(folder / "whole", events);
    const auto ends = ends_of(folder / "whole");
    for (std::size_t at = 0; at < whole.size(); ++at)
        for (const char flip : {'\x01', '\x80'}) {
            CAPTURE(at);
            std::string changed = whole;
            changed[at] = static_cast<char>(changed[at] ^ flip);
            write_bytes(folder / "changed", changed);
            if (at < hive::recording::file_magic.size()) {
                CHECK_THROWS_AS(Reader(folder / "changed"), std::runtime_error);
                continue;
            }
            Reader reader(folder / "changed");
            const auto read = read_all(reader);
            CHECK((read.damaged > 0 || read.problem != ""));
            const auto before = std::ranges::count_if(ends, [&](std::size_t end) { return end <= at; });
            CHECK(static_cast<std::ptrdiff_t>(read.texts.size()) >= before);
            for (const auto& text : read.texts)
                CHECK(whole.find(text) != std::string::npos);
        }
}

TEST_CASE("recording: an event whose content was changed is left out alone")
{
    const Folder folder;
    std::string changed = record(folder / "whole", events);
    changed[changed.find("body 3")] ^= 1;
    write_bytes(folder / "changed", changed);
    Reader reader(folder / "changed");
    const auto read = read_all(reader);
    CHECK(read.damaged == 1);
    CHECK(read.texts.size() == events - 1);
    CHECK(read.texts.back() == text_of(events - 1));
}

TEST_CASE("recording: sizes beyond the file allocate nothing, even with valid check sums")
{
    const Folder folder;
    using hive::recording::Kind;
    const hive::recording::Prefix huge_body{.kind = Kind::event, .body_size = 0xFFFFFFFF},
        huge_text{.kind = Kind::event, .text_size = 0xFFFFFFFF},
        huge_end{.kind = Kind::end, .text_size = 0xFFFFFFFF, .body_size = 0xFFFFFFFF},
        far_track{.kind = Kind::event, .track = 0xFFFFFFFF, .text_size = 2};
    for (const auto& prefix : {huge_body, huge_text, huge_end, far_track}) {
        write_bytes(folder / "forged", forged(prefix, "{}"));
        Reader reader(folder / "forged");
        CHECK_FALSE(reader.next());
        CHECK(reader.problem() != "");
        CHECK(reader.summary().tracks.empty());
    }
    std::string trailer(16, '\xFF');
    trailer.replace(8, 8, hive::recording::end_magic);
    write_bytes(folder / "forged", std::string(hive::recording::file_magic) + trailer);
    CHECK_FALSE(Reader(folder / "forged").next());
}

TEST_CASE("recording: an end that lies about places and names is not followed out of the file")
{
    const Folder folder;
    const std::string whole = record(folder / "whole", events);
    const auto end = static_cast<std::size_t>(
        hive::recording::number_in(std::as_bytes(std::span(whole)).subspan(whole.size() - 16, 8)));
    const auto with_end = [&](const std::string& text, const std::string& index) {
        const auto crc = [](const std::string& bytes) { return hive::recording::crc(std::as_bytes(std::span(bytes))); };
        const auto head =
            hive::recording::encode({hive::recording::Kind::end, 0, static_cast<std::uint32_t>(text.size()),
                                     static_cast<std::uint32_t>(index.size()), 0, crc(text), crc(index)});
        write_bytes(folder / "lie", whole.substr(0, end)
                                        + std::string(reinterpret_cast<const char*>(head.data()), head.size()) + text
                                        + index + whole.substr(whole.size() - 16));
    };
    std::string lying_index(40, '\xFF');
    lying_index[15] = lying_index[35] = '\0';                         // a time that can be
    lying_index.replace(0, 8, std::string("\x09\0\0\0\0\0\0\0", 8));  // the middle of a record
    hive::recording::Summary summary;
    summary.ended = "stopped";
    summary.tracks = {{"camera", "boxes", "a/b"}, {"camera", "image", "a/b"}};
    with_end(hive::recording::to_text(summary), lying_index);
    {
        Reader reader(folder / "lie");
        CHECK(read_all(reader).texts.size() == events);
        reader.seek(std::int64_t{1} << 60);
        CHECK_FALSE(reader.next());
    }
    summary.tracks[0].sender = "../../etc";
    with_end(hive::recording::to_text(summary), "");
    CHECK(Reader(folder / "lie").summary().tracks[0].sender == "camera");  // read from the events
    summary.tracks = {};
    with_end(hive::recording::to_text(summary), "");
    {
        Reader reader(folder / "lie");
        CHECK_FALSE(reader.next());  // of a track that there is not
        CHECK(reader.problem() != "");
    }
    with_end("[[[[", "");
    Reader reader(folder / "lie");
    CHECK(read_all(reader).texts.size() == events);
    CHECK(reader.problem() != "");
}

TEST_CASE(
    "recording: no path leads out of the folder, over a symbolic link, to something hidden or to what is no recording")
{
    const Folder folder;
    fs::create_directories(folder / "own/sub");
    fs::create_directory_symlink(folder / "own/sub", folder / "own/link");
    fs::create_symlink(folder / "outside", folder / "own/linked.hive");
    write_bytes(folder / "own/letter", "Dear Sir or Madam");
    auto wanted = settings("run.hive");
    wanted.folder = folder / "own";
    wanted.overwrite = true;
    for (const std::string path : {"../outside", "sub/../../outside", "/tmp/outside.hive", "link/a.hive", "linked.hive",
                                   ".profile", "sub/.ssh", ".ssh/keys", "letter", ".", "", "sub"}) {
        CAPTURE(path);
        wanted.path = path;
        CHECK_THROWS_AS(hive::recording::Writer{wanted}, std::runtime_error);
    }
    CHECK_FALSE(fs::exists(folder / "outside"));
    CHECK(bytes_of(folder / "own/letter") == "Dear Sir or Madam");
    for (const std::string path : {"run.hive", "sub/run.hive", "sub/../other.hive"}) {
        CAPTURE(path);
        wanted.path = path;
        hive::recording::Writer{wanted}.finish("stopped");
        hive::recording::Writer{wanted}.finish("stopped");  // a recording is overwritten
        CHECK(Reader(folder / "own" / path).summary().ended == "stopped");
        CHECK(fs::status(folder / "own" / path).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
    }
}

namespace {

std::string record_of(hive::recording::Kind kind, const std::string& text, std::int64_t time_us = 0)
{
    const auto head =
        hive::recording::encode({kind, 0, static_cast<std::uint32_t>(text.size()), 0, time_us,
                                 hive::recording::crc(std::as_bytes(std::span(text))), hive::recording::crc({})});
    return std::string(reinterpret_cast<const char*>(head.data()), head.size()) + text;
}

/// A recording of one end alone, with this text.
std::string with_end(const std::string& text)
{
    std::string place(8, '\0');
    place[0] = static_cast<char>(hive::recording::file_magic.size());
    return std::string(hive::recording::file_magic) + record_of(hive::recording::Kind::end, text) + place
           + std::string(hive::recording::end_magic);
}

std::string repeated(const std::string& text, std::size_t bytes)
{
    std::string all;
    while (all.size() < bytes)
        all += text;
    return all;
}

/// The most that this process ever had.
std::size_t max_kilobytes()
{
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
        if (word == "VmHWM:")
            return status >> word, std::stoul(word);
    return 0;
}

}  // namespace

TEST_CASE("recording: texts that are deep or wide are refused before they cost memory")
{
    const Folder folder;
    constexpr std::size_t most = hive::recording::most_end_text - 100;
    const std::size_t before = max_kilobytes();
    for (const std::string& text :
         {std::string(most / 2, '[') + std::string(most / 2, ']'), "[" + repeated("{},", most) + "{}]",
          "{\"tracks\":[" + repeated("[[]],", most) + "[]]}", "[" + repeated("0,", most) + "0]"}) {
        write_bytes(folder / "odd", with_end(text));
        Reader reader(folder / "odd");
        CHECK_FALSE(reader.next());
        CHECK(reader.problem() != "");
    }
    // The four texts here and their copies there; the values of 16 MiB of "{}," alone would be 500 MB. A sanitizer has
    // a shadow of all memory, and keeps what was freed.
    if (!hive::test::sanitized())
        CHECK(max_kilobytes() < before + 250'000);
}

TEST_CASE("recording: numbers that cannot be, in its end and in its records, are no summary and no time")
{
    const std::string whole = R"({"begun_us":1,"duration_us":2,"ended":"stopped","lost":[],"tracks":[]})";
    REQUIRE(hive::recording::summary_from(whole));
    for (const auto& [old, odd] : std::initializer_list<std::pair<std::string, std::string>>{
             {"\"duration_us\":2", "\"duration_us\":-9223372036854775808"},
             {"\"duration_us\":2", "\"duration_us\":9223372036854775807"},
             {"\"duration_us\":2", "\"duration_us\":1e300"},
             {"\"duration_us\":2", "\"duration_us\":\"2\""},
             {"\"begun_us\":1", "\"begun_us\":-1"},
             {"\"lost\":[]", R"("lost":[{"from":"a.b","reason":"c","events":-5}])"},
             {"\"lost\":[]", "\"lost\":{}"},
             {"\"tracks\":[]", "\"tracks\":[[]]"}}) {
        CAPTURE(odd);
        std::string text = whole;
        text.replace(text.find(old), old.size(), odd);
        CHECK_FALSE(hive::recording::summary_from(text));
    }
    const Folder folder;
    const auto at = [&](std::int64_t time_us) {
        write_bytes(folder / "late", std::string(hive::recording::file_magic)
                                         + record_of(hive::recording::Kind::event, text_of(1), time_us));
        return Reader(folder / "late").summary().events();
    };
    CHECK(at(hive::recording::most_time_us) == 1);
    CHECK(at(hive::recording::most_time_us + 1) == 0);
    CHECK(at(std::numeric_limits<std::int64_t>::max()) == 0);
}
