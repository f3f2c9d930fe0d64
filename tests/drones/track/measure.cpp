// measure_tracks: finder and tracker together on clips whose truth is known, in the figures of the field.
#include "scoring.hpp"
#include "seen_boxes.hpp"

#include <opencv2/core/utility.hpp>
#include <opencv2/videoio.hpp>
#include <people_finder.hpp>
#include <scene.hpp>

#include <cstdio>
#include <functional>
#include <iostream>
#include <stdexcept>

namespace {

namespace fs = std::filesystem;

using Boxes = std::vector<track::Box>;
using Truth = std::vector<scoring::TrueBox>;

track::Box box_of(const cv::Rect2d& box) { return {.x = box.x, .y = box.y, .w = box.width, .h = box.height}; }

/// One image after the other, with its truth; an empty one at the end.
struct Clip {
    std::string name;
    double fps;
    std::function<cv::Mat(Truth&)> next;
};

/// What makes boxes of an image: the drone's algorithm with the drone's defaults, or the truth itself.
using Finder = std::function<Boxes(const cv::Mat&, const Truth&)>;

Finder finder_named(const std::string& name)
{
    if (name == "truth")
        return [](const cv::Mat&, const Truth& truth) {
            Boxes boxes;
            for (const auto& one : truth)
                boxes.push_back(box_of(one.box));
            return boxes;
        };
    if (name == "background")
        return [finder = background::ForegroundFinder()](const cv::Mat& image, const Truth&) mutable {
            return hive::test::boxes_of(finder.find(image), image);
        };
    if (name == "people") {
        detect::PeopleFinder finder;
        finder.enlarge = 2;  // or most of those in surveillance videos are too small
        return [finder](const cv::Mat& image, const Truth&) {
            Boxes boxes;
            for (const auto& person : finder.find(image)) {
                boxes.push_back(box_of(person.box));
                boxes.back().score = person.score;
                const auto seen = colours::of(image, person.box);
                boxes.back().look = track::look_of({seen.begin(), seen.end()});
            }
            return boxes;
        };
    }
    throw std::invalid_argument("no boxes from " + name + "; there are background, people and truth");
}

Clip drawn(int walkers, std::uint64_t seed, int frames)
{
    camera::SceneSettings settings;
    settings.faces = 0;
    settings.walkers = walkers;
    settings.seed = seed;
    return {"drawn, " + std::to_string(walkers) + " walkers, seed " + std::to_string(seed), 30,
            [scene = camera::Scene(settings), frames, index = 0](Truth& truth) mutable {
                if (index == frames)
                    return cv::Mat();
                const auto [image, things, hands] = scene.frame(index++);
                for (const auto& [kind, id, box] : things)
                    truth.push_back({id, box});
                return image;
            }};
}

Clip filmed(const fs::path& video, const fs::path& list)
{
    cv::VideoCapture film(video.string(), cv::CAP_FFMPEG);
    if (!film.isOpened())
        throw std::runtime_error("OpenCV cannot read " + video.string());
    const double fps = film.get(cv::CAP_PROP_FPS);
    return {video.filename().string(), fps > 0 ? fps : 25,
            [film, truths = media::ground_truth(list), number = 0](Truth& truth) mutable {
                cv::Mat image;
                film.read(image);
                truth = truths[++number];
                return image;
            }};
}

/// The clips of a folder with a NAME.gt.csv next to them.
std::vector<Clip> clips_in(const fs::path& folder)
{
    std::vector<Clip> clips;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const fs::path list = folder / (entry.path().stem().string() + ".gt.csv");
        if (entry.path() != list && entry.path().extension() != ".csv" && fs::exists(list))
            clips.push_back(filmed(entry.path(), list));
    }
    std::ranges::sort(clips, {}, &Clip::name);
    if (clips.empty())
        throw std::runtime_error("no clip in " + folder.string() + " has a NAME.gt.csv beside it");
    return clips;
}

scoring::Identities measured(Clip& clip, Finder find, double enough)
{
    track::Tracker tracker;
    scoring::Identities score;
    Truth truth;
    for (int number = 0;; ++number, truth.clear()) {
        const cv::Mat image = clip.next(truth);
        if (image.empty())
            return score;
        tracker.width = image.cols;
        tracker.height = image.rows;
        score.add(tracker.next(number / clip.fps, find(image, truth)), truth, enough);
    }
}

void print(const std::string& clip, const std::string& boxes, const scoring::Identities& score)
{
    std::printf("%-34s %-10s %6d %6.1f%% %6.1f%% %8d %6d %6d\n", clip.c_str(), boxes.c_str(), score.truths,
                100 * score.mota(), 100 * score.idf1(), score.switches, score.truths - score.covered,
                score.false_tracks);
    std::fflush(stdout);
}

int run(const std::vector<std::string>& arguments)
{
    std::string boxes = "background", folder;
    double enough = 0.5;
    int frames = 600;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const auto value = [&] {
            return i + 1 < arguments.size() ? arguments[++i] : throw std::invalid_argument("a value is missing");
        };
        if (arguments[i] == "--boxes")
            boxes = value();
        else if (arguments[i] == "--overlap")
            enough = std::stod(value());
        else if (arguments[i] == "--frames")
            frames = std::stoi(value());
        else if (!arguments[i].starts_with("-") && folder.empty())
            folder = arguments[i];
        else
            throw std::invalid_argument("what is " + arguments[i] + "?");
    }
    std::vector<Clip> clips;
    if (folder.empty())
        for (const auto& [walkers, seed] : {std::pair{2, 1}, {3, 2}, {4, 3}})
            clips.push_back(drawn(walkers, static_cast<std::uint64_t>(seed), frames));
    else
        clips = clips_in(folder);
    std::printf("%-34s %-10s %6s %7s %7s %8s %6s %6s\n", "clip", "boxes", "truth", "MOTA", "IDF1", "switches", "missed",
                "false");
    for (Clip& clip : clips)
        print(clip.name, boxes, measured(clip, finder_named(boxes), enough));
    return 0;
}

}  // namespace

int main(int argc, char** argv)
try {
    cv::setNumThreads(1);  // as in the drones
    return run({argv + 1, argv + argc});
} catch (const std::exception& error) {
    std::cerr << "measure_tracks: " << error.what()
              << "\nusage: measure_tracks [FOLDER] [--boxes background|people|truth] [--overlap IOU] [--frames N]\n";
    return 2;
}
