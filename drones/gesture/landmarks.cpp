// Cuts the hand out as the network was trained, and turns joints into fingers.
#include "landmarks.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

namespace gesture {
namespace {

constexpr int input_side = 224;
constexpr std::size_t joint_numbers = 63;
/// In radii of the palm: half the side of what is cut out, and how far its middle is from that of the palm, towards the
/// fingers.
constexpr double cut_half = 3, cut_forward = 0.8;
constexpr double clearly = 1.1;

double apart(const cv::Point2d& a, const cv::Point2d& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// From the image to the input.
cv::Matx23d cut_of(const Hand& hand)
{
    const double angle = hand.angle.value_or(0) * CV_PI / 180, scale = input_side / (2 * cut_half * hand.radius);
    const cv::Point2d forward(std::sin(angle), -std::cos(angle));
    const cv::Point2d middle = cv::Point2d(hand.palm) + cut_forward * hand.radius * forward;
    const double cosine = scale * std::cos(angle), sine = scale * std::sin(angle);
    return {cosine, sine,   input_side / 2.0 - cosine * middle.x - sine * middle.y,
            -sine,  cosine, input_side / 2.0 + sine * middle.x - cosine * middle.y};
}

cv::Point2d moved(const cv::Matx23d& by, const cv::Point2d& point)
{
    return {by(0, 0) * point.x + by(0, 1) * point.y + by(0, 2), by(1, 0) * point.x + by(1, 1) * point.y + by(1, 2)};
}

}  // namespace

std::vector<cv::Point2d> extended_tips(const Joints& joints)
{
    constexpr std::size_t wrist = 0, little_root = 17, thumb_tip = 4;
    std::vector<cv::Point2d> tips;
    if (apart(joints[thumb_tip], joints[little_root]) > clearly * apart(joints[thumb_tip - 2], joints[little_root]))
        tips.push_back(joints[thumb_tip]);
    for (std::size_t tip = 8; tip < joints.size(); tip += 4)
        if (apart(joints[tip], joints[wrist]) > clearly * apart(joints[tip - 2], joints[wrist]))
            tips.push_back(joints[tip]);
    return tips;
}

HandLandmarks::HandLandmarks(const std::string& path)
{
    if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("no model at " + path);
    try {
        net_ = cv::dnn::readNetFromONNX(path);
    } catch (const cv::Exception&) {  // names lines of OpenCV; the error below is for users
        throw std::runtime_error(path + " is not an ONNX model that OpenCV's DNN can read");
    }
    choose_outputs(path);
}

/// Only a run shows whether the channels are first or last.
void HandLandmarks::choose_outputs(const std::string& path)
{
    std::string problem;
    for (const bool last : {false, true}) {
        channels_last_ = last;
        try {
            const auto outputs = run(cv::Mat::zeros(input_side, input_side, CV_8UC3));
            const auto of = [&](std::size_t numbers) {
                return std::ranges::find_if(outputs, [&](const cv::Mat& output) {
                    return output.type() == CV_32F && output.total() == numbers;
                });
            };
            const auto joints = of(joint_numbers), presence = of(1);
            if (joints != outputs.end() && presence != outputs.end()) {
                joints_ = static_cast<std::size_t>(joints - outputs.begin());
                presence_ = static_cast<std::size_t>(presence - outputs.begin());
                return;
            }
            problem = "it lacks an output of 63 numbers or of 1";
        } catch (const cv::Exception& error) {
            problem = error.err;
        }
    }
    throw std::runtime_error(path + " is not a hand landmark model with 224x224 px input: " + problem);
}

std::vector<cv::Mat> HandLandmarks::run(const cv::Mat& input)
{
    cv::Mat blob;
    if (channels_last_) {
        cv::Mat colours;
        cv::cvtColor(input, colours, cv::COLOR_BGR2RGB);
        colours.convertTo(colours, CV_32F, 1 / 255.0);
        blob = colours.reshape(1, {1, input_side, input_side, 3}).clone();
    } else {
        blob = cv::dnn::blobFromImage(input, 1 / 255.0, {input_side, input_side}, {}, true);
    }
    std::vector<cv::Mat> outputs;
    net_.setInput(blob);
    net_.forward(outputs, net_.getUnconnectedOutLayersNames());
    return outputs;
}

std::optional<Hand> HandLandmarks::read(const cv::Mat& picture, const Hand& hand)
{
    const cv::Matx23d to_input = cut_of(hand);
    cv::Matx23d back;
    cv::invertAffineTransform(to_input, back);
    cv::Mat input;
    cv::warpAffine(picture, input, to_input, {input_side, input_side}, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
    const auto outputs = run(input);
    if (!(outputs[presence_].ptr<float>()[0] >= least_presence))
        return std::nullopt;
    const float* numbers = outputs[joints_].ptr<float>();
    Joints joints;
    for (std::size_t i = 0; i < joints.size(); ++i) {
        joints[i] = moved(back, {numbers[3 * i], numbers[3 * i + 1]});
        if (!(std::abs(joints[i].x) < 1e6 && std::abs(joints[i].y) < 1e6))
            return std::nullopt;
    }
    Hand result = hand;
    std::vector<cv::Point> all(joints.begin(), joints.end());
    result.box = cv::boundingRect(all) & cv::Rect({}, picture.size());
    result.tips.clear();
    for (const cv::Point2d& tip : extended_tips(joints))
        result.tips.emplace_back(tip);
    return result;
}

}  // namespace gesture
