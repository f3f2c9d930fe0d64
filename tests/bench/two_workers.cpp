// The paper's table: one face worker, then two that share one camera, beside the same OpenCV loop without Hive.
//
//     bench_two_workers [--rounds N] [--seconds S] [--json] [--out FILE]
//
// Each round measures, one after the other: one bare loop (decode, detect, draw, encode), two bare loops at the same
// time, one worker in a swarm, two workers in a swarm; all on the same clip of 640x480 JPEGs at scale 1.05, OpenCV's
// own threads off. Results of the swarm are collected in order; a lost or doubled one ends the benchmark with exit
// code 1.
#include "swarm.hpp"

#include "scene.hpp"

#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>

namespace {

using namespace hive::test;
using Seconds = std::chrono::duration<double>;
namespace fs = std::filesystem;

constexpr int clip_images = 12;
constexpr double scale = 1.05;
constexpr auto cascade_file = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_default.xml";

void make_clip(const fs::path& folder)
{
    fs::create_directories(folder);
    const camera::Scene scene({.faces = 2});
    for (int i = 0; i < clip_images; ++i) {
        char name[32];
        std::snprintf(name, sizeof name, "%03d.jpg", i);
        cv::imwrite((folder / name).string(), scene.frame(i * 10).image, {cv::IMWRITE_JPEG_QUALITY, 90});
    }
}

std::vector<unsigned char> bytes_of(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// What one worker does to an image, in plain OpenCV.
void process(cv::CascadeClassifier& cascade, const std::vector<unsigned char>& jpeg)
{
    cv::Mat image = cv::imdecode(jpeg, cv::IMREAD_COLOR), grey;
    cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    std::vector<cv::Rect> faces;
    cascade.detectMultiScale(grey, faces, scale, 5, 0, {24, 24});
    for (const auto& box : faces)
        cv::rectangle(image, box, {0, 255, 0}, 2);
    std::vector<unsigned char> out;
    cv::imencode(".jpg", image, out, {cv::IMWRITE_JPEG_QUALITY, 80});
}

/// The child's part of a bare loop: prints frames per second.
int bare_loop(const fs::path& clip, double seconds)
{
    cv::setNumThreads(1);
    cv::CascadeClassifier cascade;
    if (!cascade.load(cascade_file))
        return 1;
    std::vector<std::vector<unsigned char>> images;
    for (const auto& entry : fs::directory_iterator(clip))
        images.push_back(bytes_of(entry.path()));
    process(cascade, images.front());
    const auto begin = Clock::now();
    int count = 0;
    while (Seconds(Clock::now() - begin).count() < seconds || count % clip_images != 0)
        process(cascade, images[static_cast<std::size_t>(count++ % clip_images)]);
    std::printf("%.4f\n", count / Seconds(Clock::now() - begin).count());
    return 0;
}

double bare_rate(const fs::path& clip, int loops, double seconds)
{
    std::vector<Process> children;
    std::vector<fs::path> logs;
    for (int i = 0; i < loops; ++i) {
        logs.push_back(clip.parent_path() / ("loop-" + std::to_string(i)));
        fs::remove(logs.back());  // a log is added to
        children.emplace_back(
            std::vector<std::string>{"/proc/self/exe", "--loop", clip.string(), std::to_string(seconds)},
            std::vector<std::string>{}, logs.back());
    }
    double sum = 0;
    for (int i = 0; i < loops; ++i) {
        if (children[static_cast<std::size_t>(i)].wait(Milliseconds(120'000)) != 0)
            throw std::runtime_error("a bare loop failed");
        double rate = 0;
        std::ifstream(logs[static_cast<std::size_t>(i)]) >> rate;
        sum += rate;
    }
    return sum;
}

/// Results of a swarm, in order and complete, counted for a while.
double swarm_rate(const fs::path& clip, int workers, double seconds)
{
    const Swarm swarm;
    std::vector<Process> processes;
    processes.push_back(swarm.drone("camera", "camera", {"source=" + clip.string(), "pace=demand"}));
    auto application = swarm.application();
    std::vector<hive::Endpoint> outputs;
    hive::ConnectionOptions options;
    options.window = 2;
    options.group = "workers";
    for (int i = 1; i <= workers; ++i) {
        const auto name = "face-" + std::to_string(i);
        processes.push_back(swarm.drone("face", name, {"scale=" + std::to_string(scale)}));
        outputs.push_back({name, "annotated"});
    }
    hive::CollectOptions collecting;
    collecting.connection.encoding = "jpeg";  // as the bare loop ends
    collecting.ordered = true;
    const auto collector = application.collect(outputs, collecting);
    for (const auto& output : outputs)
        application.connect({"camera", "image"}, {output.drone, "image"}, options);

    std::int64_t expected = 0;
    const auto take = [&] {
        const auto event = collector->next(Milliseconds(30'000));
        if (!event || event->identity.sequence != ++expected || event->body.empty())
            throw std::runtime_error("result " + std::to_string(expected) + " was lost, doubled or empty");
    };
    for (int i = 0; i < 2 * clip_images; ++i)
        take();
    const auto begin = Clock::now();
    int count = 0;
    while (Seconds(Clock::now() - begin).count() < seconds || count % clip_images != 0) {
        take();
        ++count;
    }
    return count / Seconds(Clock::now() - begin).count();
}

double median(std::vector<double> values)
{
    std::ranges::sort(values);
    const auto middle = values.size() / 2;
    return values.size() % 2 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

/// The median of round-wise ratios: noise that lasts longer than a round cancels.
double ratio(const std::vector<double>& of, const std::vector<double>& to)
{
    std::vector<double> ratios;
    for (std::size_t i = 0; i < of.size(); ++i)
        ratios.push_back(of[i] / to[i]);
    return median(ratios);
}

/// @param out  what --json prints is appended there as well; empty: nowhere
int run(int rounds, double seconds, bool json, const fs::path& out)
{
    char folder[] = "/tmp/hive-bench-XXXXXX";
    const fs::path scratch = ::mkdtemp(folder);
    const fs::path clip = scratch / "clip";
    make_clip(clip);
    std::vector<double> bare1, bare2, hive1, hive2;
    for (int round = 0; round < rounds; ++round) {
        bare1.push_back(bare_rate(clip, 1, seconds));
        hive1.push_back(swarm_rate(clip, 1, seconds));
        bare2.push_back(bare_rate(clip, 2, seconds));
        hive2.push_back(swarm_rate(clip, 2, seconds));
        std::fprintf(stderr, "round %d: bare %.2f and %.2f, Hive %.2f and %.2f frames/s\n", round + 1, bare1.back(),
                     bare2.back(), hive1.back(), hive2.back());
    }
    fs::remove_all(scratch);
    const hive::Json figures{{"rounds", rounds},
                             {"bare_fps", {median(bare1), median(bare2)}},
                             {"hive_fps", {median(hive1), median(hive2)}},
                             {"hive_to_bare", {ratio(hive1, bare1), ratio(hive2, bare2)}},
                             {"gain", ratio(hive2, hive1)},
                             {"bare_gain", ratio(bare2, bare1)}};
    if (!out.empty() && !(std::ofstream(out, std::ios::app) << figures << '\n'))
        throw std::runtime_error("cannot write " + out.string());
    if (json) {
        std::cout << figures << '\n';
        return 0;
    }
    std::printf("%-24s %12s %12s %12s %14s\n", "", "bare OpenCV", "Hive", "Hive/bare", "the paper");
    std::printf("%-24s %8.2f fps %8.2f fps %11.3f %10.1f fps\n", "one face worker", median(bare1), median(hive1),
                ratio(hive1, bare1), 2.3);
    std::printf("%-24s %8.2f fps %8.2f fps %11.3f %10.1f fps\n", "two face workers", median(bare2), median(hive2),
                ratio(hive2, bare2), 4.4);
    std::printf("%-24s %11.2fx %11.2fx %11s %13.2fx\n", "gain", ratio(bare2, bare1), ratio(hive2, hive1), "",
                4.4 / 2.3);
    std::printf("medians of %d rounds of %.0f s; 640x480, scale %.2f; results in order, none lost, none twice\n",
                rounds, seconds, scale);
    return 0;
}

}  // namespace

int main(int argc, char** argv)
{
    int rounds = 5;
    double seconds = 8;
    bool json = false;
    fs::path out;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const bool value = i + 1 < argc;
        if (word == "--loop" && i + 2 < argc)
            return bare_loop(argv[i + 1], std::atof(argv[i + 2]));
        if (word == "--rounds" && value)
            rounds = std::max(1, std::atoi(argv[++i]));
        else if (word == "--seconds" && value)
            seconds = std::atof(argv[++i]);
        else if (word == "--json")
            json = true;
        else if (word == "--out" && value)
            out = argv[++i];
        else {
            std::cerr << "usage: bench_two_workers [--rounds N] [--seconds S] [--json] [--out FILE]\n";
            return 2;
        }
    }
    try {
        return run(rounds, seconds, json, out);
    } catch (const std::exception& error) {
        std::cerr << "bench_two_workers: " << error.what() << '\n';
        return 1;
    }
}
