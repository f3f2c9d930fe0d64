// What was written is read back; limits, losses and full disks end a recording properly.
#include "files.hpp"

#include <doctest/doctest.h>

#include <csignal>
#include <sys/resource.h>

using namespace record_test;
using namespace std::chrono_literals;
using hive::recording::Reader;
using hive::recording::Writer;

namespace {

/// This process may write no file larger than this while it lives.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN))
    {
        REQUIRE(::getrlimit(RLIMIT_FSIZE, &before_) == 0);
        const rlimit little{.rlim_cur = bytes, .rlim_max = before_.rlim_max};
        REQUIRE(::setrlimit(RLIMIT_FSIZE, &little) == 0);
    }
    ~FileSizeLimit()
    {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit before_{};
    void (*signal_)(int);
};

}  // namespace

TEST_CASE("recording: what was written is read back, event by event, with its times and tracks")
{
    const Folder folder;
    record(folder / "a", 25);
    Reader reader(folder / "a");
    const auto& summary = reader.summary();
    CHECK(summary.ended == "stopped");
    CHECK(summary.events() == 25);
    CHECK(summary.duration_us == 2'400'000);
    REQUIRE(summary.tracks.size() == 2);
    CHECK(summary.tracks[0].from() == "camera.boxes");
    CHECK(summary.tracks[0].events == 13);
    CHECK(summary.tracks[1].first_us == 100'000);
    CHECK(summary.tracks[1].last_us == 2'300'000);
    CHECK(summary.lossless());
    for (int i = 0; i < 25; ++i) {
        const auto record = reader.next();
        REQUIRE(record);
        CHECK(record->prefix.time_us == 100'000 * i);
        CHECK(record->prefix.track == static_cast<std::uint32_t>(i % 2));
        CHECK(reader.text(*record) == text_of(i));
    }
    CHECK_FALSE(reader.next());
    CHECK(reader.problem() == "");
}

TEST_CASE("recording: an empty one is complete; another file is refused")
{
    const Folder folder;
    record(folder / "empty", 0);
    Reader reader(folder / "empty");
    CHECK(reader.summary().ended == "stopped");
    CHECK_FALSE(reader.next());
    CHECK(reader.problem() == "");
    write_bytes(folder / "text", "no recording at all");
    write_bytes(folder / "nothing", "");
    for (const auto* name : {"text", "nothing", "missing", "."})
        CHECK_THROWS_AS(Reader(folder / name), std::runtime_error);
}

TEST_CASE("recording: a file that is there is refused, unless it may be replaced; so are folders, missing folders and "
          "a file that is being recorded")
{
    const Folder folder;
    record(folder / "a", 3);
    auto wanted = settings(folder / "a");
    CHECK_THROWS_WITH_AS(Writer{wanted}, doctest::Contains("already exists"), std::runtime_error);
    CHECK(Reader(folder / "a").summary().events() == 3);
    wanted.overwrite = true;
    {
        Writer writer(wanted);
        append(writer, 0);
        CHECK_THROWS_WITH_AS(Writer{wanted}, doctest::Contains("another process"), std::runtime_error);
    }
    CHECK(Reader(folder / "a").summary().events() == 1);
    CHECK_THROWS_AS(Writer(settings(folder / "no/such")), std::runtime_error);
    wanted.path = folder / ".";
    CHECK_THROWS_AS(Writer{wanted}, std::runtime_error);
}

TEST_CASE("recording: seeking by the index finds the first event of every time")
{
    const Folder folder;
    record(folder / "a", 100);
    Reader reader(folder / "a");
    for (int i = 0; i < 100; ++i) {
        reader.seek(100'000 * i);
        int passed = 0;
        auto record = reader.next();
        for (; record && record->prefix.time_us < 100'000 * i; record = reader.next())
            ++passed;
        REQUIRE(record);
        CHECK(reader.text(*record) == text_of(i));
        CHECK(passed <= 12);  // an entry a second: it is not the file that is read
    }
}

TEST_CASE("recording: limits end it before they are exceeded, and later events are not losses")
{
    const Folder folder;
    auto wanted = settings(folder / "size");
    wanted.limits.bytes = 20'000;
    {
        Writer writer(wanted);
        int taken = 0;
        while (append(writer, taken))
            ++taken;
        CHECK(taken > 10);
        CHECK(writer.ended() == "max_size reached");
        CHECK_FALSE(append(writer, taken));
        CHECK(writer.summary().lossless());
    }
    CHECK(fs::file_size(folder / "size") <= 20'000);
    CHECK(Reader(folder / "size").problem() == "");

    wanted = settings(folder / "time");
    wanted.limits.duration = 1s;
    Writer writer(wanted);
    const Clock::time_point begin{};
    writer.look(begin + 100s);
    CHECK(writer.ended() == "");  // time runs from the first event
    CHECK(append(writer, 0, begin));
    writer.look(begin + 999ms);
    CHECK(writer.ended() == "");
    writer.look(begin + 1s);
    CHECK(writer.ended() == "max_duration reached");
    CHECK_FALSE(append(writer, 1, begin));
}

TEST_CASE("recording: when the disk is full, the file is ended there, and lists the losses")
{
    const Folder folder;
    constexpr rlim_t most = 64 * 1024;
    int taken = 0, refused = 0;
    {
        const FileSizeLimit limit(most);
        Writer writer(settings(folder / "full"));
        for (; append(writer, taken); ++taken)
            REQUIRE(taken < 10'000);
        CHECK(writer.failure() == "disk full");
        {
            Reader early(folder / "full");  // before its end is written
            CHECK(early.summary().ended == "disk full");
            CHECK(early.problem() == "");
        }
        for (refused = 1; refused < 11; ++refused)
            CHECK_FALSE(append(writer, taken + refused));
        writer.lost("other.output", "never came", 7);
        writer.finish("stopped");
    }
    CHECK(fs::file_size(folder / "full") <= most);
    Reader reader(folder / "full");
    CHECK(reader.summary().ended == "disk full");
    std::int64_t lost = 0;
    for (const auto& loss : reader.summary().lost)
        lost += loss.events;
    CHECK(lost == refused + 7);
    const auto read = read_all(reader);
    REQUIRE(read.texts.size() == static_cast<std::size_t>(taken));
    CHECK(read.texts.back() == text_of(taken - 1));
    CHECK(read.problem == "");
}

TEST_CASE("recording: missing space at the start is reported at the start, and leaves no file")
{
    const Folder folder;
    const FileSizeLimit limit(100);
    CHECK_THROWS_WITH_AS(Writer(settings(folder / "none")), doctest::Contains("disk full"), std::runtime_error);
    CHECK_FALSE(fs::exists(folder / "none"));
}

TEST_CASE("recording: ports have the names of the outputs; where they are the same, those of the drones too")
{
    const auto names = [](const std::vector<hive::recording::Track>& tracks) {
        std::string text;
        for (const auto& port : hive::recording::ports_of(tracks))
            text += port.name + ":" + port.types + " ";
        return text;
    };
    CHECK(names({{"camera", "image", "image/raw"},
                 {"face", "faces", "application/json"},
                 {"camera", "image", "image/jpeg"}})
          == "image:image/raw,image/jpeg faces:application/json ");
    CHECK(names({{"left", "image", "a/b"}, {"right", "image", "a/b"}}) == "left-image:a/b right-image:a/b ");
    CHECK(names({{"face", "exceptions", "a/b"}}) == "face-exceptions:a/b ");
    CHECK(names({{"a", "b-c", "x/y"}, {"a-b", "c", "x/y"}, {"z", "b-c", "x/y"}, {"z", "c", "x/y"}})
          == "a-b-c:x/y output-2:x/y z-b-c:x/y z-c:x/y ");
}
