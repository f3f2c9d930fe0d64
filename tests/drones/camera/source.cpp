// Sources: their texts, refusals with reasons, and the order of their images.
#include "media.hpp"
#include "source.hpp"
#include "video_source.hpp"

#include <doctest/doctest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <cmath>
#include <string>

using camera::open_source;
using camera::source_kind;
using camera::SourceKind;
using camera::SourceSettings;

namespace {

SourceSettings once(const std::string& text)
{
    SourceSettings settings;
    settings.text = text;
    settings.loop = false;
    return settings;
}

std::string refusal(const std::string& text)
{
    try {
        open_source(once(text));
    } catch (const std::exception& problem) {
        return problem.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// At 12 fps; each image is brighter than the one before.
std::string write_clip(const std::filesystem::path& path, int images)
{
    cv::VideoWriter writer(path.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < images; ++i)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i % 250)));
    return path.string();
}

}  // namespace

TEST_CASE("source: the text determines the kind")
{
    const media::Folder folder;
    const auto path = [&](const char* name) {
        media::write(folder.path() / name, {1});
        return (folder.path() / name).string();
    };
    CHECK(source_kind("scene") == SourceKind::scene);
    CHECK(source_kind("scene:noise") == SourceKind::scene);
    CHECK(source_kind("http://camera/mjpg?x=a@b") == SourceKind::url);
    CHECK(source_kind("rtsp://[::1]:554/live") == SourceKind::url);
    CHECK(source_kind(path("a.JPG")) == SourceKind::image);
    CHECK(source_kind(path("a.mp4")) == SourceKind::video);
    CHECK(source_kind(folder.path().string()) == SourceKind::folder);
    CHECK(camera::is_live(SourceKind::device));
    CHECK_FALSE(camera::is_live(SourceKind::video));
}

TEST_CASE("source: what a device gives is held against what it was asked for")
{
    using camera::DeviceForm;
    const DeviceForm got{"MJPG", {1280, 720}, 29.97};
    CHECK(camera::to_text(got) == "MJPG 1280x720 at 30 fps");
    CHECK(camera::to_text({"", {640, 480}, 0}) == "640x480");
    CHECK(camera::fits({}, got));
    CHECK(camera::fits({"MJPG", {1280, 720}, 30}, got));
    CHECK(camera::fits({"", {1280, 720}, 30}, {"YUYV", {1280, 720}, 0}));  // its rate is unknown
    CHECK_FALSE(camera::fits({"YUYV", {1280, 720}, 30}, got));
    CHECK_FALSE(camera::fits({"MJPG", {640, 480}, 30}, got));
    CHECK_FALSE(camera::fits({"MJPG", {1280, 720}, 60}, got));
    CHECK(camera::is_format("MJPG"));
    CHECK(camera::is_format(""));
    CHECK_FALSE(camera::is_format("MJPEG"));
    CHECK_FALSE(camera::is_format("a b"));
}

TEST_CASE("source: a refusal names the missing part")
{
    CHECK(contains(refusal("/nowhere/at/all.mp4"), "no such file: /nowhere/at/all.mp4"));
    CHECK(contains(refusal("scene:sea"), "unknown source scene:sea"));
    CHECK(contains(refusal("/dev/video987"), "no such device: /dev/video987"));
    CHECK(contains(refusal("ftp://host/x"), "ftp://"));
    CHECK(contains(refusal("http:///x"), "no host"));
    CHECK(contains(refusal(""), "empty"));
    CHECK(contains(refusal("/dev/null"), "neither a file nor a folder"));
    const media::Folder folder;
    CHECK(contains(refusal(folder.path().string()), "no images in"));
    media::write(folder.path() / "not.mp4", {'n', 'o'});
    CHECK(contains(refusal((folder.path() / "not.mp4").string()), "not a video"));
}

TEST_CASE("source: a URL with a password is refused, and the refusal does not repeat it")
{
    for (const char* url :
         {"http://root:secret@camera/mjpg", "rtsp://root:secret@camera", "https://secret@camera/?a=b"}) {
        CHECK(contains(refusal(url), "must not contain"));
        CHECK_FALSE(contains(refusal(url), "secret"));
    }
    CHECK(camera::shown_source("http://camera/mjpg?token=secret") == "http://camera/mjpg");
}

TEST_CASE("source: a JPEG file is given as its bytes, untouched")
{
    const media::Folder folder;
    const media::Bytes jpeg = media::encoded(".jpg", media::sample({40, 30}, CV_8UC3));
    media::write(folder.path() / "a.jpg", jpeg);
    const auto source = open_source(once((folder.path() / "a.jpg").string()));
    const auto frame = source->next();
    REQUIRE(frame);
    REQUIRE(frame->jpeg);
    CHECK(*frame->jpeg == jpeg);
    CHECK(frame->image.empty());
    CHECK_FALSE(source->next());
}

TEST_CASE("source: a folder returns its images by name, once or in a loop")
{
    const media::Folder folder;
    for (const int i : {3, 1, 2})
        media::write(folder.path() / (std::to_string(i) + ".png"),
                     media::encoded(".png", cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(i))));
    media::write(folder.path() / "notes.txt", {'x'});
    const auto source = open_source(once(folder.path().string()));
    for (int i = 0; i < 3; ++i) {
        const auto frame = source->next();
        REQUIRE(frame);
        CHECK(frame->index == i);
        CHECK(frame->image.at<cv::Vec3b>(0, 0)[0] == i + 1);
        CHECK_FALSE(frame->knows_truth);
    }
    CHECK_FALSE(source->next());
    SourceSettings looped = once(folder.path().string());
    looped.loop = true;
    const auto endless = open_source(looped);
    for (int i = 0; i < 7; ++i)
        CHECK(endless->next()->index == i % 3);
}

TEST_CASE("source: a damaged image in a folder is reported and skipped")
{
    const media::Folder folder;
    media::write(folder.path() / "1.png", {1, 2, 3});
    media::write(folder.path() / "2.png", media::encoded(".png", cv::Mat(4, 4, CV_8UC3, cv::Scalar::all(2))));
    const auto source = open_source(once(folder.path().string()));
    CHECK_THROWS_WITH(source->next(), doctest::Contains("1.png"));
    CHECK(source->next()->index == 1);
}

TEST_CASE("source: a folder has every format that OpenCV reads, under any name, and reports skipped files")
{
    const media::Folder folder;
    const cv::Mat image = media::sample({20, 10}, CV_8UC3);
    for (const char* ending : {".bmp", ".png", ".ppm", ".ras", ".tiff", ".webp"})
        media::write(folder.path() / ("a" + std::string(ending)), media::encoded(ending, image));
    media::write(folder.path() / "b.dat", media::encoded(".png", image));
    media::write(folder.path() / "notes.txt", {'x'});
    media::write(folder.path() / ".hidden", {'x'});
    const auto source = open_source(once(folder.path().string()));
    CHECK(source->count() == 7);
    int count = 0;
    while (const auto frame = source->next()) {
        CAPTURE(frame->file);
        CHECK(frame->image.size() == image.size());
        ++count;
    }
    CHECK(count == 7);
    const auto news = source->news();
    REQUIRE(news.size() == 1);
    CHECK(contains(news[0], "skipped"));
    CHECK(contains(news[0], "notes.txt"));
    CHECK_FALSE(contains(news[0], "hidden"));
}

TEST_CASE("source: grey images of 16 bits keep them, others are as cv::imread gives them")
{
    const media::Folder folder;
    for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
        const auto path = (folder.path() / (std::to_string(type) + ".png")).string();
        const cv::Mat image = media::sample({40, 30}, type);
        media::write(path, media::encoded(".png", image));
        const auto frame = open_source(once(path))->next();
        REQUIRE(frame);
        CHECK(media::same(frame->image, type == CV_16UC1 ? image : cv::imread(path)));
    }
}

TEST_CASE("source: the scene has its size, by default 640x480, and ground truth")
{
    SourceSettings settings = once("scene:plain");
    CHECK(open_source(settings)->next()->image.size() == cv::Size(640, 480));
    settings.size = {320, 0};
    const auto frame = open_source(settings)->next();
    CHECK(frame->image.size() == cv::Size(320, 240));
    CHECK(frame->knows_truth);
    CHECK(frame->truth.size() == 1);
    settings.size = {10, 10};
    CHECK_THROWS(open_source(settings));
}

TEST_CASE("source: a video returns every image once, or in a loop")
{
    const media::Folder folder;
    const std::string path = (folder.path() / "v.avi").string();
    cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 12, {64, 48});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 10; ++i)
        writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(20 * i)));
    writer.release();
    const auto source = open_source(once(path));
    CHECK(source->fps() == doctest::Approx(12));
    std::vector<cv::Mat> images;
    while (auto frame = source->next()) {
        CHECK(frame->index == static_cast<std::int64_t>(images.size()));
        images.push_back(frame->image);
    }
    REQUIRE(images.size() == 10);
    for (int i = 0; i < 10; ++i)  // each keeps its own pixels
        CHECK(cv::mean(images[static_cast<std::size_t>(i)])[0] == doctest::Approx(20 * i).epsilon(0.05));
    SourceSettings looped = once(path);
    looped.loop = true;
    const auto endless = open_source(looped);
    for (int i = 0; i < 25; ++i) {
        const auto frame = endless->next();
        REQUIRE(frame);
        CHECK(frame->index == i % 10);
        CHECK(media::same(frame->image, images[static_cast<std::size_t>(i % 10)]));
    }
}

TEST_CASE("source: an image of a video has its file, its time there and the rate, in each round")
{
    const media::Folder folder;
    const std::string path = write_clip(folder.path() / "v.avi", 10);
    SourceSettings looped = once(path);
    looped.loop = true;
    const auto source = open_source(looped);
    for (int i = 0; i < 25; ++i) {
        const auto frame = source->next();
        REQUIRE(frame);
        CHECK(frame->file == path);
        CHECK(frame->fps == doctest::Approx(12));
        REQUIRE(frame->media_time);
        CHECK(std::abs(frame->media_time->count() - i % 10 * 1'000'000 / 12) <= 1000);
        CHECK(frame->restarts == (i > 0 && i % 10 == 0));
    }
    CHECK(source->count() == 0);
    CHECK(open_source(once(path))->count() == 10);
}

TEST_CASE("source: a truncated clip reports its length, once")
{
    const media::Folder folder;
    const std::string path = write_clip(folder.path() / "v.avi", 100);
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    const auto source = open_source(once(path));
    int count = 0;
    while (source->next())
        ++count;
    CHECK(count > 20);
    CHECK(count < 80);
    CHECK(contains(source->cut_short(), path + ": " + std::to_string(count) + " of 100 frames"));
    SourceSettings looped = once(path);
    looped.loop = true;
    const auto endless = open_source(looped);
    std::size_t told = 0;
    for (int i = 0; i < 5 * count; ++i) {
        endless->next();
        told += endless->news().size();
    }
    CHECK(told == 1);
    const auto whole = open_source(once(write_clip(folder.path() / "w.avi", 30)));
    while (whole->next()) {
    }
    CHECK(whole->cut_short().empty());
}

TEST_CASE("source: the media's videos and the GIF have as many images as they should (needs media)")
{
    struct Case {
        const char* name;
        int images;
    };
    for (const Case& video :
         {Case{"face_over_brick.mp4", 120}, {"head-pose-face-detection-male.gif", 62}, {"asl_thanks.mkv", 51}})
        if (const auto path = media::shared(std::string("media/") + video.name)) {
            const auto source = open_source(once(path->string()));
            int count = 0;
            while (source->next())
                ++count;
            CAPTURE(std::string(video.name));
            CHECK(count == video.images);
        }
}
