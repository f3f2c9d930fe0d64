// Network cameras against plain OpenCV, with GStreamer's server: the time to the first image at several rates, and
// how old images are when they have come through the drone. measure_rtsp [SECONDS]; scripts/measure-rtsp runs it.
#include "measure.hpp"
#include "rtsp_server.hpp"

#include <hive/vision/image.hpp>

#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <cstdio>
#include <cstdlib>

using namespace hive::test;
using namespace std::chrono_literals;

namespace {

using Seconds = std::chrono::duration<double>;

/// Takes the time of one function.
template <class Function>
double seconds_of(Function function)
{
    const auto begin = Clock::now();
    function();
    return Seconds(Clock::now() - begin).count();
}

/// The milliseconds since 1970 that an image shows: their lower 32 bits.
std::uint32_t time_shown(const cv::Mat& image)
{
    cv::Mat grey = image;
    if (image.channels() == 3)
        cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
    std::uint32_t time = 0;
    for (int field = 0; field < 32; ++field)
        time = time << 1 | (cv::mean(grey(cv::Rect(10 * field + 3, 100, 4, 40)))[0] > 125 ? 1 : 0);
    return time;
}

double age_ms(const cv::Mat& image)
{
    const auto now =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch());
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(now.count()) - time_shown(image));
}

hive::Event image_of(hive::Collector& collector)
{
    auto event = collector.next(30'000ms);
    if (!event)
        throw std::runtime_error("no image came within 30 s");
    return *event;
}

double first_image_of_opencv(const std::string& url)
{
    return seconds_of([&] {
        cv::VideoCapture capture;
        cv::Mat image;
        if (!capture.open(url, cv::CAP_FFMPEG) || !capture.read(image))
            throw std::runtime_error("OpenCV does not open " + url);
    });
}

/// The first one of a source; earlier ones are of the previous source.
void await_image(hive::Collector& collector, const std::string& source)
{
    while (image_of(collector).header.at("source") != source) {
    }
}

double first_image_of_hive(hive::Application& application, hive::Collector& collector, const std::string& url)
{
    application.set("camera", {{"source", "scene"}});
    await_image(collector, "scene");
    return seconds_of([&] {
        application.set("camera", {{"source", url}});
        await_image(collector, url);
    });
}

void print_first_images(const Swarm& swarm)
{
    constexpr int rounds = 5;
    std::puts("| fps | first image, OpenCV | first image, Hive | Hive/OpenCV |\n|---|---|---|---|");
    const auto camera = swarm.drone("camera", "camera");
    auto application = swarm.application();
    const auto collector = application.collect({{"camera", "image"}});
    int number = 0;
    for (const char* fps : {"1", "5", "12", "30"}) {
        const RtspServer server(swarm, rtsp_port(number++), fps);
        if (!server.ready())
            throw std::runtime_error("no RTSP server here: " + server.said());
        std::vector<double> opencv, hive;
        for (int round = 0; round < rounds; ++round) {
            opencv.push_back(first_image_of_opencv(server.url()));
            hive.push_back(first_image_of_hive(application, *collector, server.url()));
        }
        std::printf("| %s | %.2f s | %.2f s | %.2f |\n", fps, median(opencv), median(hive),
                    median(hive) / median(opencv));
        std::fflush(stdout);
    }
}

/// The age at which a share of the images was at most as old.
double quantile(std::vector<double> ages, double share)
{
    std::ranges::sort(ages);
    return ages.at(static_cast<std::size_t>(share * static_cast<double>(ages.size() - 1)));
}

void print_ages(const Swarm& swarm, std::chrono::seconds time)
{
    const RtspServer server(swarm, rtsp_port(9), "30", {"--clock"});
    const auto camera = swarm.drone("camera", "camera", {"source=" + server.url()});
    auto application = swarm.application();
    const auto collector = application.collect({{"camera", "image"}});
    std::vector<double> ages;
    image_of(*collector);
    std::puts("\n| until | images | median age | 99 % below | oldest |\n|---|---|---|---|---|");
    const auto begin = Clock::now();
    for (auto next = begin + time / 10; Clock::now() < begin + time;) {
        ages.push_back(age_ms(hive::vision::decode(image_of(*collector))));
        if (Clock::now() < next)
            continue;
        std::printf("| %.0f s | %zu | %.0f ms | %.0f ms | %.0f ms |\n", Seconds(Clock::now() - begin).count(),
                    ages.size(), quantile(ages, 0.5), quantile(ages, 0.99), quantile(ages, 1));
        std::fflush(stdout);
        next += time / 10;
        ages.clear();
    }
}

}  // namespace

int main(int count, char** words)
try {
    const int seconds = count > 1 ? std::atoi(words[1]) : 600;
    if (seconds < 10)
        throw std::runtime_error("usage: measure_rtsp [SECONDS, at least 10]");
    const Swarm swarm;
    print_first_images(swarm);
    print_ages(swarm, std::chrono::seconds(seconds));
    return 0;
} catch (const std::exception& problem) {
    std::fprintf(stderr, "measure_rtsp: %s\n", problem.what());
    return 1;
}
