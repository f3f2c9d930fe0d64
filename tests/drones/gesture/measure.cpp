// measure_gestures: counts the fingers in images whose number of fingers is known, by each way that the drone has.
#include <hand_search.hpp>
#include <opencv2/core/utility.hpp>
#include <opencv2/imgcodecs.hpp>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <stdexcept>

namespace {

using gesture::Hand;

struct Way {
    std::string name;
    std::function<std::vector<Hand>(const cv::Mat&)> find;
    std::map<std::string, int> right = {};  ///< by the true number of fingers
};

std::vector<Hand> by_silhouette(const cv::Mat& image, const char* from)
{
    gesture::Silhouette silhouette;
    silhouette.from = from;
    return gesture::GestureFinder().find(silhouette.of(image));
}

std::vector<Way> ways(const std::string& cascade)
{
    const auto search = std::make_shared<gesture::HandSearch>();
    search->load_faces(cascade);
    return {{"mask", [](const cv::Mat& image) { return by_silhouette(image, "mask"); }},
            {"skin", [](const cv::Mat& image) { return by_silhouette(image, "skin"); }},
            {"search", [search](const cv::Mat& image) { return search->find(image); }}};
}

/// "5", or "-" when there is no hand.
std::string count_text(const std::vector<Hand>& hands)
{
    return hands.empty() ? "-" : std::to_string(hands[0].tips.size());
}

void draw(const std::string& folder, const std::string& name, cv::Mat image, const std::vector<Hand>& hands)
{
    gesture::draw(image, hands);
    cv::imwrite(folder + "/" + name + ".png", image);
}

int run(std::vector<std::string> arguments)
{
    std::string folder, cascade = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml";
    if (arguments.size() >= 2 && arguments[0] == "--draw") {
        folder = arguments[1];
        arguments.erase(arguments.begin(), arguments.begin() + 2);
    }
    if (arguments.empty())
        throw std::invalid_argument("no image");
    auto all = ways(cascade);
    std::map<std::string, int> images;  ///< by the true number of fingers
    std::printf("%-34s %7s", "image", "fingers");
    for (const Way& way : all)
        std::printf(" %7s", way.name.c_str());
    std::printf("\n");
    for (const std::string& argument : arguments) {
        const auto sign = argument.rfind('=');
        const std::string path = argument.substr(0, sign),
                          truth = sign == std::string::npos ? "?" : argument.substr(sign + 1),
                          name = std::filesystem::path(path).stem().string();
        const cv::Mat image = cv::imread(path);
        if (image.empty())
            throw std::runtime_error("OpenCV cannot read " + path);
        std::printf("%-34s %7s", name.c_str(), truth.c_str());
        for (Way& way : all) {
            const auto hands = way.find(image);
            way.right[truth] += count_text(hands) == truth ? 1 : 0;
            std::printf(" %7s", count_text(hands).c_str());
            if (!folder.empty() && way.name == "search")
                draw(folder, name, image.clone(), hands);
        }
        std::printf("\n");
        ++images[truth];
    }
    for (const auto& [truth, count] : images) {
        std::printf("%-34s %7s", ("right of " + std::to_string(count)).c_str(), truth.c_str());
        for (Way& way : all)
            std::printf(" %7d", way.right[truth]);
        std::printf("\n");
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv)
try {
    cv::setNumThreads(1);  // as in the drone
    return run({argv + 1, argv + argc});
} catch (const std::exception& error) {
    std::cerr << "measure_gestures: " << error.what() << "\nusage: measure_gestures [--draw FOLDER] IMAGE=FINGERS...\n";
    return 2;
}
