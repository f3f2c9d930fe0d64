// Videos and folders: every image with its time, also when the file is cut off.
#include "file_times.hpp"
#include "media.hpp"
#include "reading.hpp"
#include "sink.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <csignal>
#include <set>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

using namespace std::chrono_literals;
namespace fs = std::filesystem;

namespace {

/// Uneven, as those of a camera.
std::chrono::microseconds time_of(int index) { return std::chrono::microseconds(33'367 * index + (index % 3) * 4'000); }

void add_images(writing::Sink& sink, int count, cv::Size size = {64, 48}, int type = CV_8UC3)
{
    const cv::Mat image = media::sample(size, type);
    for (int i = 0; i < count; ++i)
        sink.add({.pixels = image, .sequence = i + 1, .fps = 30}, time_of(i));
}

/// How far the times in a file are from those that were given, at most.
double largest_error(const std::vector<double>& times)
{
    double largest = 0;
    for (std::size_t i = 0; i < times.size(); ++i)
        largest =
            std::max(largest, std::abs(times[i] - std::chrono::duration<double>(time_of(static_cast<int>(i))).count()));
    return largest;
}

std::string refusal(const writing::Settings& settings)
{
    try {
        writing::open_sink(settings);
    } catch (const std::exception& problem) {
        return problem.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("write: a video has every image at its time, within a millisecond")
{
    const media::Folder folder;
    for (const char* name : {"a.mp4", "b.mkv", "with:colon %d.mov"}) {
        CAPTURE(std::string(name));
        const std::string path = (folder.path() / name).string();
        const auto sink = writing::open_sink({.path = path});
        add_images(*sink, 100);
        sink->close();
        CHECK_FALSE(sink->encoder().empty());
        const auto times = times_in(path);
        REQUIRE(times.size() == 100);
        CHECK(largest_error(times) <= 0.001);
        cv::VideoCapture video(path, cv::CAP_FFMPEG);
        CHECK(video.get(cv::CAP_PROP_FRAME_WIDTH) == 64);
    }
}

TEST_CASE("write: an AVI has a constant rate, so its times are rounded to that")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "a.avi").string();
    const auto sink = writing::open_sink({.path = path});
    add_images(*sink, 30);
    sink->close();
    CHECK(largest_error(times_in(path)) <= 0.04);
}

TEST_CASE("write: a video that is cut off at any moment can be played up to the last second")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "a.mp4").string(), copy = (folder.path() / "copy.mp4").string();
    const auto sink = writing::open_sink({.path = path});
    add_images(*sink, 150);  // five seconds
    fs::copy_file(path, copy);
    const auto times = times_in(copy);
    CHECK(times.size() >= 110);
    CHECK(times.size() < 150);
    CHECK(largest_error(times) <= 0.001);
    cv::VideoCapture video(copy, cv::CAP_FFMPEG);
    int images = 0;
    for (cv::Mat image; video.read(image);)
        ++images;
    CHECK(images == static_cast<int>(times.size()));
}

TEST_CASE("write: grey, 16 bits, odd sides and a change of size are no reason to fail")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "a.mp4").string();
    const auto sink = writing::open_sink({.path = path});
    int index = 0;
    for (const cv::Mat& image : {media::sample({63, 47}, CV_8UC1), media::sample({63, 47}, CV_16UC1),
                                 media::sample({63, 47}, CV_8UC3), media::sample({128, 96}, CV_8UC3)})
        sink->add({.pixels = image}, time_of(index++));
    sink->close();
    CHECK(times_in(path).size() == 4);
}

TEST_CASE("write: a folder keeps JPEG files byte for byte, 16 bits as PNG, and lists the times")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "out" / "").string();
    const media::Bytes jpeg = media::encoded(".jpg", media::sample({40, 30}, CV_8UC3));
    const cv::Mat deep = media::sample({40, 30}, CV_16UC1);
    const auto sink = writing::open_sink({.path = path});
    CHECK(sink->takes_encoded(".jpg"));
    sink->add({.pixels = {}, .encoded = jpeg, .extension = ".jpg", .sequence = 7}, 0us);
    sink->add({.pixels = deep, .sequence = 9}, 40'000us);
    sink->close();
    CHECK(media::read(path + "00000001.jpg") == jpeg);
    CHECK(media::same(cv::imread(path + "00000002.png", cv::IMREAD_UNCHANGED), deep));
    const auto table = media::read(path + "times.csv");
    CHECK(std::string(table.begin(), table.end()) == "file,seq,time_us\n00000001.jpg,7,0\n00000002.png,9,40000\n");
}

TEST_CASE("write: an invalid file is refused before the first image, with the reason")
{
    const media::Folder folder;
    media::write(folder.path() / "there.mp4", {1});
    const auto path = [&](const char* name) { return (folder.path() / name).string(); };
    CHECK(contains(refusal({.path = path("there.mp4")}), "exists already"));
    CHECK(refusal({.path = path("there.mp4"), .overwrite = true}).empty());
    CHECK(contains(refusal({.path = path("a.gif")}), "unknown extension"));
    CHECK(contains(refusal({.path = path("nowhere/a.mp4")}), "no such folder"));
    CHECK(contains(refusal({.path = folder.path().string()}), "not empty"));
    CHECK_FALSE(fs::exists(path("a.mp4")));
}

TEST_CASE("write: a failure to write is reported, and earlier images stay")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "a.mp4").string();
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{60'000, before.rlim_max};
    const auto sink = writing::open_sink({.path = path, .quality = 95});
    setrlimit(RLIMIT_FSIZE, &small);
    std::string problem;
    try {
        for (int i = 0; i < 300; ++i)
            sink->add({.pixels = media::sample({160, 120}, CV_8UC3, i)}, time_of(i));
    } catch (const std::exception& error) {
        problem = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK_MESSAGE(contains(problem, "too large"), problem);
    CHECK(fs::file_size(path) <= 60'000);
    CHECK_FALSE(times_in(path).empty());
}

TEST_CASE("write: nothing is read past the end of an image of any size")
{
    const media::Folder folder;
    int number = 0;
    for (const cv::Size size : {cv::Size(321, 241), {319, 240}, {320, 241}, {322, 242}, {17, 15}}) {
        CAPTURE(size.width);
        const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE)),
                   bytes = static_cast<std::size_t>(size.area()) * 3, pages = (bytes + page - 1) / page * page;
        void* const memory = mmap(nullptr, pages + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        REQUIRE(memory != MAP_FAILED);
        mprotect(static_cast<char*>(memory) + pages, page, PROT_NONE);
        const cv::Mat image(size, CV_8UC3, static_cast<char*>(memory) + pages - bytes);
        const auto path = (folder.path() / (std::to_string(number++) + ".mkv")).string();
        const auto sink = writing::open_sink({.path = path});
        for (int i = 0; i < 3; ++i)
            sink->add({.pixels = image, .fps = 30}, time_of(i));
        sink->close();
        munmap(memory, pages + page);
        CHECK(times_in(path).size() == 3);
    }
}

TEST_CASE("write: after a failure only readable images are counted")
{
    const media::Folder folder;
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    for (const char* name : {"a.mp4", "a.mkv", "a.avi"}) {
        CAPTURE(std::string(name));
        const std::string path = (folder.path() / name).string();
        const auto sink = writing::open_sink({.path = path, .quality = 95});
        const rlimit small{600'000, before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &small);
        int taken = 0;
        const auto fill = [&] {
            for (; taken < 300; ++taken)
                sink->add({.pixels = media::sample({160, 120}, CV_8UC3, taken), .fps = 30}, time_of(taken));
        };
        CHECK_THROWS_AS(fill(), std::runtime_error);
        try {
            sink->close();
        } catch (const std::runtime_error&) {
        }
        setrlimit(RLIMIT_FSIZE, &before);
        const auto held = sink->held();
        REQUIRE(held);
        const auto times = times_in(path);
        CHECK(held->images > 0);
        CHECK(held->images <= taken);
        CHECK(std::abs(held->images - std::ssize(times)) <= 1);  // the last may be there in part
        CHECK(std::abs(std::chrono::duration<double>(held->last).count()
                       - times[static_cast<std::size_t>(held->images) - 1])
              < 0.001);
    }
}

TEST_CASE("write: a video that could not be started reports why, and can be closed")
{
    const media::Folder folder;
    const fs::path below = folder.path() / "below";
    fs::create_directory(below);
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    cv::Size size{64, 48};
    const auto sink = writing::open_sink({.path = (below / "a.mp4").string()});
    SUBCASE("its folder is gone") { fs::remove(below); }
    SUBCASE("the disk takes no header")
    {
        const rlimit none{0, before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &none);
    }
    SUBCASE("no encoder takes the size") { size = {70'000, 2}; }
    CHECK_THROWS_AS(add_images(*sink, 1, size), std::runtime_error);
    setrlimit(RLIMIT_FSIZE, &before);
    CHECK_NOTHROW(sink->close());
}

TEST_CASE("write: overwriting a folder removes its numbered images and nothing else")
{
    const media::Folder folder;
    for (const char* name : {"00000001.png", "00000002.jpg", "2.jpg", "00000002.jpg.txt", "000000003.jpg"})
        media::write(folder.path() / name, {1});
    fs::create_directory(folder.path() / "00000004.jpg");
    const auto sink = writing::open_sink({.path = folder.path().string(), .overwrite = true});
    add_images(*sink, 1);
    sink->close();
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder.path()))
        names.insert(entry.path().filename().string());
    CHECK(names
          == std::set<std::string>{"00000001.jpg", "2.jpg", "00000002.jpg.txt", "000000003.jpg", "00000004.jpg",
                                   "times.csv"});
}

TEST_CASE("times: the intervals of one clock are kept, another clock continues where the last ended")
{
    writing::FileTimes times;
    CHECK(times.next({"a", 5'000'000, 0}) == 0us);
    CHECK(times.next({"a", 5'040'000, 0}) == 40'000us);
    CHECK(times.next({"a", 5'140'000, 0}) == 140'000us);
    CHECK(times.next({"b", 77, 25}) == 180'000us);  // at the usual distance of its source
    CHECK(times.next({"b", 100'077, 25}) == 280'000us);
    CHECK(times.next({"b", 0, 0}) == 380'000us);              // back: as far as the last two were apart
    CHECK(times.next({"b", 3'600'000'000, 0}) == 480'000us);  // an hour later
}
