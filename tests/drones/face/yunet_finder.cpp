// A made-up model of YuNet's form: its converted numbers, and refusals.
#include "yunet_model.hpp"

#include <doctest/doctest.h>
#include <yunet_finder.hpp>

#include <algorithm>

using face::YunetFinder;
using onnx::yunet_model;

namespace {

std::string refusal(const std::string& path)
{
    try {
        static_cast<void>(YunetFinder(path).find(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(9))));
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("yunet: a face is where the model's numbers say, with its score and points")
{
    const onnx::File file(".onnx", onnx::bytes_of(yunet_model()));
    YunetFinder finder(file.path());
    for (const int type : {CV_8UC3, CV_8UC1}) {
        const auto faces = finder.find(cv::Mat(32, 32, type, cv::Scalar::all(9)));
        REQUIRE(faces.size() == 1);
        CHECK(faces[0].box == cv::Rect(12, 4, 16, 16));  // around 20,12
        CHECK(faces[0].score == doctest::Approx(0.9));
        for (const auto& point : faces[0].points)
            CHECK(cv::norm(point - cv::Point2f(20, 12)) < 0.01);
    }
    finder.min_score = 0.4;
    finder.overlap = 0.9;
    CHECK(finder.find(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(9))).size() == 2);
}

TEST_CASE("yunet: another model is refused in a sentence, at once or at the first image of a wrong size")
{
    onnx::Model other = yunet_model();
    other.more.pop_back();
    const onnx::File good(".onnx", onnx::bytes_of(yunet_model())), two(".onnx", onnx::bytes_of(other)),
        garbage(".onnx", "this is no model");
    CHECK(refusal(good.path()) == "accepted");
    CHECK(refusal("/nowhere/yunet.onnx") == "no model at /nowhere/yunet.onnx");
    CHECK(refusal(garbage.path()).find("is not an ONNX model") != std::string::npos);
    CHECK(refusal(two.path()).find("is not a YuNet") != std::string::npos);
    YunetFinder finder(good.path());
    CHECK_THROWS_AS(static_cast<void>(finder.find(cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(9)))), std::runtime_error);
    CHECK(finder.find(cv::Mat(32, 32, CV_8UC3, cv::Scalar::all(9))).size() == 1);
}
