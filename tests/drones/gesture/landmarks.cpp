// Landmarks of a made-up model: fingers out of joints, places in the picture, and what is refused.
#include "../detect/onnx_writer.hpp"

#include <doctest/doctest.h>
#include <landmarks.hpp>

#include <algorithm>

using gesture::HandLandmarks;
using gesture::Joints;

namespace {

/// An upright hand in an input of 224x224 px: the named fingers (0 is the thumb) are straight, the others bent.
Joints joints_with(const std::vector<int>& straight)
{
    Joints joints;
    joints[0] = {112, 190};  // the wrist
    for (int finger = 0; finger < 5; ++finger) {
        const bool is = std::ranges::find(straight, finger) != straight.end();
        const double x = 70 + 20.0 * finger, top = is ? 30 : 115;
        for (int joint = 0; joint < 4; ++joint)
            joints[static_cast<std::size_t>(1 + 4 * finger + joint)] = {x, 120 + (top - 120) * joint / 3.0
                                                                               - (is ? 0 : (joint == 1 ? 25 : 0))};
    }
    if (std::ranges::find(straight, 0) != straight.end())  // the thumb goes aside
        for (int joint = 0; joint < 4; ++joint)
            joints[static_cast<std::size_t>(1 + joint)] = {70 - 15.0 * joint, 140 - 5.0 * joint};
    else
        for (int joint = 0; joint < 4; ++joint)
            joints[static_cast<std::size_t>(1 + joint)] = {70 + 12.0 * joint, 140};
    return joints;
}

onnx::Model model(const Joints& joints, float presence)
{
    onnx::Model result{.width = 224, .height = 224, .shape = {1, 1}, .constants = {presence}, .wires = {}};
    std::vector<float> numbers;
    for (const auto& joint : joints)
        for (const double number : {joint.x, joint.y, 0.0})
            numbers.push_back(static_cast<float>(number));
    result.more.push_back({"landmarks", {1, 63}, numbers});
    return result;
}

std::string refusal(const std::string& path)
{
    try {
        const HandLandmarks landmarks(path);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("landmarks: straight fingers are counted, bent ones are not")
{
    for (const std::vector<int>& straight : {std::vector<int>{}, {1}, {1, 2}, {0, 4}, {1, 2, 3, 4}, {0, 1, 2, 3, 4}}) {
        CAPTURE(straight.size());
        CHECK(gesture::extended_tips(joints_with(straight)).size() == straight.size());
    }
}

TEST_CASE("landmarks: the tips are where the model says, in the picture, also of a hand that is turned")
{
    const onnx::File file(".onnx", onnx::bytes_of(model(joints_with({1, 2}), 0.9F)));
    HandLandmarks landmarks(file.path());
    gesture::Hand hand;
    hand.palm = {300, 200};
    hand.radius = 30;  // 180 px are cut out, so a px of the input is 0.80 px
    const cv::Mat picture(480, 640, CV_8UC3, cv::Scalar::all(90));
    const auto upright = landmarks.read(picture, hand);
    REQUIRE(upright);
    REQUIRE(upright->tips.size() == 2);
    CHECK(cv::norm(upright->tips[0] - cv::Point(282, 110)) < 2);
    hand.angle = 90;  // to the right
    const auto turned = landmarks.read(picture, hand);
    REQUIRE(turned);
    CHECK(cv::norm(turned->tips[0] - cv::Point(390, 182)) < 2);
}

TEST_CASE("landmarks: what the model takes for no hand is none")
{
    const onnx::File file(".onnx", onnx::bytes_of(model(joints_with({1}), 0.3F)));
    gesture::Hand hand;
    hand.palm = {50, 50};
    hand.radius = 20;
    CHECK_FALSE(HandLandmarks(file.path()).read(cv::Mat(100, 100, CV_8UC3, cv::Scalar::all(90)), hand));
}

TEST_CASE("landmarks: what is no such model is refused in a sentence")
{
    const onnx::File garbage(".onnx", "this is no model"),
        other(".onnx",
              onnx::bytes_of({.width = 224, .height = 224, .shape = {1, 2}, .constants = {1, 2}, .wires = {}}));
    CHECK(refusal("/nowhere/hand.onnx") == "no model at /nowhere/hand.onnx");
    CHECK(refusal(garbage.path()).find("is not an ONNX model") != std::string::npos);
    CHECK(refusal(other.path()).find("is not a hand landmark model") != std::string::npos);
}
