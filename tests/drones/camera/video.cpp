// Videos as ffmpeg writes them: which are complete, which are reported as damaged, at what time each frame is, which
// pixels.
#include "media.hpp"
#include "source.hpp"

#include <doctest/doctest.h>
#include <opencv2/videoio.hpp>
#include <possible.hpp>

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

bool has_ffmpeg()
{
    return hive::test::possible(fs::exists("/usr/bin/ffmpeg") ? "" : "ffmpeg, of Debian's package of that name");
}

/// @param from  arguments for the input of ffmpeg; empty: 45 drawn frames at 30 per second
std::string made(const media::Folder& folder, const std::string& name, const std::string& options,
                 const std::string& from = "")
{
    const auto path = (folder.path() / name).string();
    const std::string input = from.empty() ? "-f lavfi -i testsrc=size=320x240:rate=30:duration=1.5" : from;
    const auto command = "/usr/bin/ffmpeg -v error " + input + " " + options + " " + path;
    REQUIRE_MESSAGE(std::system(command.c_str()) == 0, command);
    return path;
}

/// 20 frames at 30 a second, then 9 at 10 a second.
constexpr const char* uneven = R"(-vf "setpts='if(lt(N,20),N,3*N-40)'" -vsync vfr -frames:v 29 )";

double due(int index) { return index < 20 ? index / 30.0 : 20 / 30.0 + (index - 20) / 10.0; }

struct Played {
    std::vector<cv::Mat> images;
    std::vector<double> times;  ///< s
    std::string complaint;
    std::int64_t count = 0;
};

Played play(const std::string& path)
{
    camera::SourceSettings settings;
    settings.text = path;
    settings.loop = false;
    const auto source = camera::open_source(settings);
    Played played;
    while (const auto frame = source->next()) {
        played.images.push_back(frame->image);
        played.times.push_back(frame->media_time ? static_cast<double>(frame->media_time->count()) / 1e6 : -1);
    }
    played.complaint = source->cut_short();
    played.count = source->count();
    return played;
}

bool complains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("video: a file that is read to its end is complete, for any estimate of its container (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    const auto plain = made(folder, "plain.mp4", "-c:v libx264 -g 15");
    struct Case {
        std::string path;
        std::size_t frames;
    };
    const std::string longer_sound = "-f lavfi -i sine=duration=4 -c:v copy -c:a aac";
    for (const Case& file :
         {Case{made(folder, "a.flv", "-c:v libx264 -bf 2"), 45},
          {made(folder, "uneven.mkv", uneven + std::string("-c:v libx264")), 29},
          {made(folder, "uneven.mp4", uneven + std::string("-c:v libx264")), 29},
          {made(folder, "uneven.avi", uneven + std::string("-c:v mpeg4")), 29},
          {made(folder, "sound.mkv", longer_sound, "-i " + plain), 45},
          {made(folder, "trimmed.mp4", "-c copy", "-ss 0.7 -i " + plain), 24},
          {made(folder, "fragments.mp4", "-c copy -movflags frag_keyframe+empty_moov", "-i " + plain), 45},
          {made(folder, "a.gif", ""), 45},
          {made(folder, "one.mkv", "-frames:v 1"), 1}}) {
        CAPTURE(file.path);
        const auto played = play(file.path);
        CHECK(played.complaint.empty());
        CHECK(played.images.size() == file.frames);
        CHECK(played.count == static_cast<std::int64_t>(file.frames));
        CHECK(played.times[0] == 0);
    }
}

TEST_CASE("video: one that starts in the middle of a broadcast is complete from its first image (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    for (const char* codec : {"-c:v libx264", "-c:v mpeg2video"}) {
        CAPTURE(std::string(codec));
        const auto path = made(folder, std::string(codec + 7) + ".ts", codec + std::string(" -g 15"));
        const media::Bytes whole = media::read(path);
        media::write(path, media::Bytes(whole.begin() + 188 * 20, whole.end()));
        const auto played = play(path);
        CHECK(played.complaint.empty());
        CHECK(played.images.size() >= 15);
        CHECK(played.images.size() < 45);
    }
    // More bytes before it than FFmpeg probes: the decoder refuses the first packets.
    const auto path = made(folder, "large.ts", "-c:v libx264 -preset ultrafast -qp 1 -g 15",
                           "-f lavfi -i testsrc2=size=640x480:rate=30:duration=1,noise=alls=100:allf=t");
    const media::Bytes whole = media::read(path);
    REQUIRE(whole.size() > 15'000'000);
    media::write(path, media::Bytes(whole.begin() + 188 * 2'000, whole.end()));
    const auto played = play(path);
    CHECK_MESSAGE(played.complaint.empty(), played.complaint);
    CHECK(played.images.size() == 15);
}

TEST_CASE("video: a truncated or damaged one is reported, and its content is played (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    const auto mp4 = made(folder, "a.mp4", "-c:v libx264 -movflags +faststart");
    for (const auto& path : {mp4, made(folder, "a.mkv", "-c:v libx264"), made(folder, "a.flv", "-c:v flv"),
                             made(folder, "a.avi", "-c:v mpeg4"), made(folder, "jpegs.avi", "-c:v mjpeg"),
                             made(folder, "a.mpg", "-c:v mpeg1video"), made(folder, "a.gif", ""),
                             made(folder, "fragments.mp4", "-c copy -movflags frag_keyframe", "-i " + mp4)}) {
        CAPTURE(path);
        const media::Bytes whole = media::read(path);
        media::write(path, media::Bytes(whole.begin(), whole.begin() + std::ssize(whole) * 7 / 10));
        const auto cut = play(path);
        CHECK_MESSAGE(complains(cut.complaint, "frames: the file is damaged or was cut short"), cut.complaint);
        CHECK(cut.images.size() >= 15);
        CHECK(cut.images.size() < 45);
        media::Bytes damaged = whole;
        std::minstd_rand random(1);
        for (std::size_t i = 0; i < 600; ++i)
            damaged[whole.size() * 6 / 10 + i] = static_cast<unsigned char>(random());
        media::write(path, damaged);
        CHECK(complains(play(path).complaint, "damaged or was cut short"));
    }
    const media::Bytes whole = media::read(made(folder, "b.mp4", "-c:v libx264 -movflags +faststart"));
    media::write(mp4, media::Bytes(whole.begin(), whole.begin() + std::ssize(whole) * 7 / 10));
    CHECK(complains(play(mp4).complaint, " of 45 frames: the file is"));  // by its index
    const auto path = made(folder, "no_start.ts", "-c:v libx264 -g 100");
    const media::Bytes stream = media::read(path);
    media::write(path, media::Bytes(stream.begin() + 188 * 20, stream.end()));
    CHECK(complains(play(path).complaint, ": 0 of "));
}

TEST_CASE("video: the reason why one cannot be opened is reported (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    const auto path = made(folder, "a.mp4", "-c:v libx264");
    const media::Bytes whole = media::read(path);
    media::write(path, media::Bytes(whole.begin(), whole.begin() + std::ssize(whole) / 2));
    CHECK_THROWS_WITH(play(path), doctest::Contains("moov atom not found"));
    media::write(path, {});
    CHECK_THROWS_WITH(play(path), doctest::Contains("it is empty"));
    CHECK_THROWS_WITH(play(made(folder, "a.wav", "-f lavfi -i sine=duration=1 -map 1:a")),
                      doctest::Contains("it contains no video"));
}

TEST_CASE("video: frames over 40 Mpixel are reported, not decoded (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    const auto giant = [&](const std::string& size) {
        return made(folder, size + ".mkv", "-frames:v 1 -c:v png", "-f lavfi -i color=size=" + size);
    };
    CHECK(play(giant("7000x5000")).images.size() == 1);
    const auto path = giant("8000x6000");
    const auto read = [&] {
        try {
            const auto played = play(path);
            CHECK(played.images.empty());
            return played.complaint;
        } catch (const std::runtime_error& error) {
            return std::string(error.what());
        }
    };
    const auto said = read();
    CHECK_MESSAGE(complains(said, path), said);
}

TEST_CASE("video: each frame has the time at which the file presents it, to the last (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    for (const char* name : {"reordered.mp4", "reordered.mkv"}) {
        CAPTURE(std::string(name));
        const auto times = play(made(folder, name, uneven + std::string("-c:v libx264 -bf 2"))).times;
        REQUIRE(times.size() == 29);
        for (int i = 0; i < 29; ++i)
            CHECK(std::abs(times[static_cast<std::size_t>(i)] - due(i)) <= 0.001);
    }
    const auto times = play(made(folder, "reordered.avi", "-c:v mpeg4 -bf 2")).times;
    REQUIRE(times.size() == 45);
    for (int i = 0; i < 45; ++i)
        CHECK(std::abs(times[static_cast<std::size_t>(i)] - i / 30.0) <= 0.001);
}

TEST_CASE("video: the pixels are those of OpenCV for every size and format (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    int number = 0;
    for (const char* options : {"-c:v libx264", "-vf scale=322:242 -c:v libx264", "-vf scale=318:180 -c:v libx264",
                                "-vf scale=321:241 -c:v mjpeg", "-vf scale=854:480 -pix_fmt yuv420p10le -c:v libx264",
                                "-vf scale=326:240 -flags +ilme+ildct -c:v mpeg2video"}) {
        CAPTURE(std::string(options));
        const auto path = made(folder, std::to_string(number++) + ".mkv", options);
        const auto played = play(path);
        REQUIRE(played.images.size() == 45);
        cv::VideoCapture plain(path, cv::CAP_FFMPEG);
        cv::Mat expected;
        for (const cv::Mat& image : played.images) {
            REQUIRE(plain.read(expected));
            CHECK(media::same(image, expected));
        }
    }
}

TEST_CASE("video: one that was filmed with the camera on its side is shown upright (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    const auto path = made(folder, "a.mp4", "-c:v libx264");
    const cv::Mat plain = play(path).images.at(0);
    // Against the clock, as ffmpeg 5.1 writes it and players show it; OpenCV 4.6 turns it the other way round.
    for (const int degrees : {90, 180, 270}) {
        CAPTURE(degrees);
        const auto text = std::to_string(degrees);
        const auto turned =
            play(made(folder, text + ".mp4", "-metadata:s:v rotate=" + text + " -c copy", "-i " + path));
        cv::Mat expected;
        cv::rotate(plain, expected, 3 - degrees / 90);
        CHECK(media::same(turned.images.at(0), expected));
        CHECK(turned.images.size() == 45);
    }
}

TEST_CASE("video: a looped one that was removed is refused until it is back (needs ffmpeg)")
{
    if (!has_ffmpeg())
        return;
    const media::Folder folder;
    camera::SourceSettings settings;
    settings.text = made(folder, "a.mkv", "-frames:v 3");
    settings.loop = true;
    const auto source = camera::open_source(settings);
    for (int i = 0; i < 3; ++i)
        REQUIRE(source->next());
    const media::Bytes whole = media::read(settings.text);
    fs::remove(settings.text);
    for (int i = 0; i < 2; ++i)
        CHECK_THROWS_WITH(source->next(), doctest::Contains("is not a video that can be read"));
    media::write(settings.text, whole);
    const auto again = source->next();
    REQUIRE(again);
    CHECK(again->restarts);
    CHECK(again->index == 0);
}
