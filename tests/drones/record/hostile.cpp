// Files that are cut, changed or made up: what is whole is read, what is wrong is noticed, and nothing is believed.
#include "files.hpp"

#include <doctest/doctest.h>

#include <algorithm>

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

TEST_CASE("recording: sizes that the file cannot hold allocate nothing, whatever their check sums say")
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
