// Compares the results of the drones with those of plain OpenCV for an image or a clip: compare_media SOURCE [IMAGES]
// prints in how many images the faces and the masks of the foreground are the same; compare_media --formats FOLDER
// writes an image in each format. For scripts/media-table.
#include "swarm.hpp"

#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>
#include <opencv2/video/background_segm.hpp>
#include <opencv2/videoio.hpp>

#include <array>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

using namespace hive::test;

namespace {

/// x, y, w, h
using Boxes = std::set<std::array<int, 4>>;
/// By the number of the image, from 1.
struct Found {
    std::map<std::int64_t, Boxes> faces;
    std::map<std::int64_t, cv::Mat> masks;
};

/// The images of a file in turn; an empty one at the end.
std::function<cv::Mat()> images_of(const std::string& source)
{
    if (const cv::Mat image = cv::imread(source); !image.empty())
        return [image, given = false]() mutable { return std::exchange(given, true) ? cv::Mat() : image; };
    return [video = cv::VideoCapture(source, cv::CAP_FFMPEG)]() mutable {
        cv::Mat image;
        video.read(image);
        return image;
    };
}

/// With the method on the page of the face drone.
Boxes faces_in(cv::CascadeClassifier& cascade, const cv::Mat& image)
{
    cv::Mat grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::Rect> faces;
    cascade.detectMultiScale(grey, faces, 1.1, 5, 0, {24, 24});
    Boxes boxes;
    for (const auto& face : faces)
        boxes.insert({face.x, face.y, face.width, face.height});
    return boxes;
}

/// With the method on the page of the background drone, and light=100: OpenCV does not adapt to changes of the light.
cv::Mat mask_of(cv::BackgroundSubtractor& subtractor, const cv::Mat& image, std::int64_t number)
{
    const auto disc = [](int radius) {
        return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1});
    };
    cv::Mat mask;
    subtractor.apply(image, mask, 1.0 / 500);
    if (number <= 4)
        mask.setTo(0);
    cv::morphologyEx(mask, mask, cv::MORPH_OPEN, disc(1));
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, disc(5));
    return mask;
}

Found by_opencv(const std::string& source, int most)
{
    cv::CascadeClassifier cascade("/usr/share/opencv4/haarcascades/haarcascade_frontalface_default.xml");
    const auto subtractor = cv::createBackgroundSubtractorMOG2(500, 16, false);
    const auto next = images_of(source);
    Found found;
    for (std::int64_t number = 1; number <= most; ++number) {
        const cv::Mat image = next();
        if (image.empty())
            break;
        found.faces[number] = faces_in(cascade, image);
        found.masks[number] = mask_of(*subtractor, image, number);
    }
    return found;
}

void add(Found& found, const hive::Event& event)
{
    if (event.output == "mask")
        found.masks[event.identity.sequence] = hive::vision::decode(event).clone();
    else
        for (auto& boxes = found.faces[event.identity.sequence]; const auto& face : event.header.at("faces"))
            boxes.insert(
                {face.at("x").get<int>(), face.at("y").get<int>(), face.at("w").get<int>(), face.at("h").get<int>()});
}

Found by_drones(const std::string& source, int most)
{
    const Swarm swarm;
    const auto face = swarm.drone("face", "face");
    const auto background = swarm.drone("background", "background", {"light=100"});
    const auto camera = swarm.drone("camera", "camera", {"source=" + source, "pace=demand", "loop=off"}, {"--halted"});
    auto application = swarm.application();
    const auto collector = application.collect({{"face", "faces"}, {"background", "mask"}});
    application.connect({"camera", "image"}, {"face", "image"});
    application.connect({"camera", "image"}, {"background", "image"});
    application.resume("camera");
    Found found;
    const auto enough = static_cast<std::size_t>(most);
    while (found.faces.size() < enough || found.masks.size() < enough)
        if (const auto event = collector->next(Milliseconds(20'000)))
            add(found, *event);
        else
            break;
    return found;
}

/// "100 of 100"
template <class Value, class Same>
std::string agreement(const std::map<std::int64_t, Value>& expected, const std::map<std::int64_t, Value>& got,
                      Same same)
{
    int agree = 0;
    for (const auto& [number, value] : expected)
        if (const auto found = got.find(number); found != got.end())
            agree += same(value, found->second) ? 1 : 0;
    return std::to_string(agree) + " of " + std::to_string(expected.size());
}

void compare(const std::string& source, int most)
{
    cv::setNumThreads(1);  // as the drones
    const Found plain = by_opencv(source, most), drones = by_drones(source, most);
    const auto same_mask = [](const cv::Mat& a, const cv::Mat& b) {
        return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
    };
    std::size_t faces = 0;
    for (const auto& [number, boxes] : plain.faces)
        faces += boxes.size();
    std::printf("%s (%zu faces) | %s\n", agreement(plain.faces, drones.faces, std::equal_to<Boxes>()).c_str(), faces,
                agreement(plain.masks, drones.masks, same_mask).c_str());
}

/// An image with edges and colours, moved a little.
cv::Mat drawn(int number)
{
    cv::Mat image(120, 160, CV_8UC3, cv::Scalar(90, 120, 60));
    cv::circle(image, {40 + 3 * number, 60}, 25, {40, 60, 220}, -1);
    cv::putText(image, std::to_string(number), {90, 80}, cv::FONT_HERSHEY_SIMPLEX, 1, {240, 240, 240}, 2);
    return image;
}

void write_formats(const std::string& folder)
{
    for (const char* ending :
         {"jpg", "png", "tif", "webp", "bmp", "jp2", "ppm", "pgm", "ras", "pbm", "pfm", "exr", "hdr"})
        try {
            const std::string file = folder + "/picture." + ending;
            const bool grey = file.ends_with("pgm") || file.ends_with("pbm");
            cv::Mat image = drawn(1);
            if (grey)
                cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
            cv::imwrite(file, image);
        } catch (const cv::Exception&) {  // OpenCV was built without it, or writes it from other numbers only
        }
    for (const auto& [name, code] :
         {std::pair{"motion-jpeg.avi", "MJPG"}, {"mpeg4.mp4", "mp4v"}, {"ffv1.mkv", "FFV1"}}) {
        cv::VideoWriter video(folder + "/" + name, cv::CAP_FFMPEG,
                              cv::VideoWriter::fourcc(code[0], code[1], code[2], code[3]), 12, {160, 120});
        for (int i = 0; i < 20; ++i)
            video.write(drawn(i));
    }
}

}  // namespace

int main(int count, char** words)
try {
    const std::vector<std::string> given(words + 1, words + count);
    if (given.size() == 2 && given[0] == "--formats")
        write_formats(given[1]);
    else if (given.size() == 1 || given.size() == 2)
        compare(given[0], given.size() == 2 ? std::stoi(given[1]) : 100);
    else
        throw std::runtime_error("usage: compare_media SOURCE [IMAGES] | --formats FOLDER");
    return 0;
} catch (const std::exception& problem) {
    std::fprintf(stderr, "compare_media: %s\n", problem.what());
    return 1;
}
