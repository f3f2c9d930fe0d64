// Real (tiny) ONNX models through OpenCV's DNN: what they are given, what is made of what they say, and what is
// refused.
#include "onnx_writer.hpp"

#include <doctest/doctest.h>
#include <network.hpp>
#include <onnx_file.hpp>
#include <opencv2/core.hpp>

#include <algorithm>
#include <array>

using detect::Network;
using detect::NetworkSettings;

namespace {

/// A model of 8x8 px with this output, whatever it is shown.
onnx::Model constant(std::vector<int> shape, std::vector<float> numbers)
{
    return {.shape = std::move(shape), .constants = std::move(numbers), .wires = {}};
}

/// One object of the first of two classes, left of the middle of the input, in each layout.
onnx::Model yolo5()
{
    std::vector<float> rows(7 * 7);  // as many as numbers in a row, so that its shape tells without names
    std::ranges::copy(std::array{3.0F, 4.0F, 2.0F, 4.0F, 0.9F, 1.0F}, rows.begin());
    return constant({1, 7, 7}, rows);
}
onnx::Model yolo8() { return constant({1, 6, 2}, {3, 0, 4, 0, 2, 0, 4, 0, 0.9F, 0, 0, 0}); }
onnx::Model ssd() { return constant({1, 1, 2, 7}, {0, 0, 0.9F, 0.25F, 0.25F, 0.5F, 0.75F, -1, 0, 0, 0, 0, 0, 0}); }

NetworkSettings settings(const onnx::File& model, const onnx::File* classes = nullptr)
{
    NetworkSettings result;
    result.model = model.path();
    result.classes = classes ? classes->path() : "";
    result.input = {8, 8};
    return result;
}

/// Why there can be no such network.
std::string refusal(const NetworkSettings& wanted)
{
    try {
        const Network network(wanted);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "accepted";
}

cv::Mat grey_picture(cv::Size size) { return {size, CV_8UC3, cv::Scalar::all(50)}; }

}  // namespace

TEST_CASE("network: each layout of a model is found out, and its box is where the model says")
{
    const onnx::File names(".names", "cup\r\nspoon\n\n");
    struct Case {
        onnx::Model model;
        detect::Layout layout;
    };
    for (const Case& known :
         {Case{yolo5(), detect::Layout::rows}, {yolo8(), detect::Layout::columns}, {ssd(), detect::Layout::corners}}) {
        const onnx::File model(".onnx", onnx::bytes_of(known.model));
        Network network(settings(model, &names));
        CHECK(network.layout() == known.layout);
        const auto objects = network.find(grey_picture({80, 80}));
        REQUIRE(objects.size() == 1);
        CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
        CHECK(objects[0].name == "cup");
        CHECK(objects[0].score == doctest::Approx(0.9));
    }
}

TEST_CASE("network: lists with the suppression inside, and boxes apart from their scores, are found out as well")
{
    onnx::Model apart = constant({1, 2, 4}, {0.25F, 0.25F, 0.5F, 0.75F, 0, 0, 0.1F, 0.1F});
    apart.more.push_back({"scores", {1, 2, 3}, {0.05F, 0.9F, 0.05F, 0.9F, 0.05F, 0.05F}});
    onnx::Model finished = constant({1, 2, 6}, {2, 2, 4, 6, 0.9F, 1, 0, 0, 0, 0, 0, 0}),
                numbered = constant({1, 7}, {0, 2, 2, 4, 6, 1, 0.9F});
    const onnx::File names(".names", "background\ncup\nspoon\n");
    for (const auto& [known, layout] : {std::pair(&apart, detect::Layout::apart),
                                        {&finished, detect::Layout::finished},
                                        {&numbered, detect::Layout::numbered}}) {
        CAPTURE(std::string(detect::name_of(layout)));
        const onnx::File model(".onnx", onnx::bytes_of(*known));
        Network network(settings(model, &names));
        CHECK(network.layout() == layout);
        const auto objects = network.find(grey_picture({80, 80}));
        REQUIRE(objects.size() == 1);
        CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
        CHECK(objects[0].name == "cup");
        CHECK(objects[0].score == doctest::Approx(0.9));
    }
}

TEST_CASE("network: the size of the input and the names of the classes are read from the model's file, unless told")
{
    onnx::Model model = yolo8();
    model.width = 16;
    model.names = "{0: 'cup', 1: \"cat's bed\"}";
    const onnx::File file(".onnx", onnx::bytes_of(model)), names(".names", "first\nsecond\n");
    NetworkSettings wanted = settings(file);
    wanted.input = {};
    Network network(wanted);
    CHECK(network.input() == cv::Size(16, 8));
    CHECK(network.classes() == 2);
    CHECK(network.find(grey_picture({160, 80})).at(0).name == "cup");
    wanted.classes = names.path();
    CHECK(Network(wanted).find(grey_picture({160, 80})).at(0).name == "first");
}

TEST_CASE("network: a layout that is told is the only one that is considered")
{
    const onnx::File file(".onnx", onnx::bytes_of(constant({1, 7, 6}, std::vector<float>(42))));
    NetworkSettings wanted = settings(file);
    CHECK(Network(wanted).layout() == detect::Layout::finished);
    wanted.layout = "yolov5";
    CHECK(Network(wanted).layout() == detect::Layout::rows);
    wanted.layout = "ssd";
    CHECK(refusal(wanted).find("which is no output of the layout ssd") != std::string::npos);
}

TEST_CASE("model card: damaged files, other files and no files tell nothing")
{
    const std::string whole = onnx::bytes_of(yolo8());
    const onnx::File good(".onnx", whole);
    CHECK(detect::model_card(good.path()).input == cv::Size(8, 8));
    CHECK(detect::model_card(good.path()).names.empty());
    for (std::size_t length = 0; length < whole.size(); length += 7) {
        const onnx::File cut(".onnx", whole.substr(0, length));
        CHECK(detect::model_card(cut.path()).names.empty());
    }
    for (std::size_t place = 0; place < whole.size(); place += 5) {
        std::string changed = whole;
        changed[place] = static_cast<char>(changed[place] ^ 0xff);
        const onnx::File damaged(".onnx", changed);
        const cv::Size size = detect::model_card(damaged.path()).input;
        CHECK(size.width <= 4096);
        CHECK(size.height <= 4096);
    }
    CHECK(detect::model_card("/nowhere/model.onnx") == detect::ModelCard{});
    CHECK(detect::model_card("/") == detect::ModelCard{});
}

TEST_CASE("model card: names are read in the order of their numbers, or not at all")
{
    CHECK(detect::names_from("{0: 'person', 1: 'bicycle'}") == std::vector<std::string>{"person", "bicycle"});
    CHECK(detect::names_from("{ 0 : \"a, b}\" }") == std::vector<std::string>{"a, b}"});
    CHECK(detect::names_from("{}").empty());
    for (const char* wrong :
         {"", "{", "person", "{0: 'a' 1: 'b'}", "{1: 'a'}", "{0: 'a', 2: 'b'}", "{0: 'a", "{0: a}", "{0 'a'}"})
        CHECK(detect::names_from(wrong).empty());
}

TEST_CASE("network: a wide picture is letterboxed or stretched into the input, and its boxes are mapped back")
{
    const onnx::File model(".onnx", onnx::bytes_of(ssd()));
    NetworkSettings wanted = settings(model);
    CHECK(Network(wanted).find(grey_picture({160, 80}))[0].box == cv::Rect(40, 0, 40, 80));
    CHECK(Network(wanted).find(grey_picture({80, 160}))[0].box == cv::Rect(0, 40, 40, 80));
    wanted.fit = "stretch";
    CHECK(Network(wanted).find(grey_picture({160, 80}))[0].box == cv::Rect(40, 20, 40, 40));
    CHECK(Network(wanted).find(cv::Mat(80, 160, CV_8UC1, cv::Scalar(7)))[0].box == cv::Rect(40, 20, 40, 40));
}

TEST_CASE("network: the picture reaches the model scaled, without the mean, in the model's order of colours")
{
    // The scores of the three classes are the three channels of the input's first pixel.
    onnx::Model model = constant({1, 2, 8}, {4, 4, 4, 4, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
    model.wires = {{0, 5, 1}, {64, 6, 1}, {128, 7, 1}};
    const onnx::File file(".onnx", onnx::bytes_of(model)), names(".names", "first\nsecond\nthird\n");
    NetworkSettings wanted = settings(file, &names);
    const cv::Mat blue(8, 8, CV_8UC3, cv::Scalar(204, 20, 10));
    const auto seen = [&] {
        Network network(wanted);
        network.min_score = 0.1;
        return network.find(blue).at(0);
    };
    CHECK(seen().name == "third");
    CHECK(seen().score == doctest::Approx(0.8));
    wanted.swap = false;
    CHECK(seen().name == "first");
    wanted.mean = detect::mean_from("153,0,0");
    CHECK(seen().score == doctest::Approx(0.2).epsilon(0.01));
}

TEST_CASE("network: what is not seen well enough is left out")
{
    const onnx::File file(".onnx", onnx::bytes_of(yolo5()));
    Network network(settings(file));
    network.min_score = 0.95;
    CHECK(network.find(grey_picture({80, 80})).empty());
    network.min_score = 0.85;
    CHECK(network.find(grey_picture({80, 80})).size() == 1);
}

TEST_CASE("network: of overlapping boxes of one class the best is kept; other classes and places are not touched; "
          "boxes end at the picture")
{
    const onnx::File file(
        ".onnx",
        onnx::bytes_of(constant({1, 7, 7}, {2,     2,  2,  2,    1, 0.7F, 0, 2.2F, 2, 2,    2, 1, 0.9F, 0, 2, 2, 2,
                                            2,     1,  0,  0.8F, 6, 6,    2, 2,    1, 0.6F, 0, 8, 8,    4, 4, 1, 0,
                                            0.95F, 20, 20, 2,    2, 1,    1, 0,    0, 0,    0, 0, 0,    0, 0})));
    Network network(settings(file));
    const auto objects = network.find(grey_picture({80, 80}));
    REQUIRE(objects.size() == 4);
    CHECK(objects[0].box == cv::Rect(60, 60, 20, 20));
    CHECK(objects[1].score == doctest::Approx(0.9));
    CHECK(objects[2].name == "1");
    CHECK(objects[3].box == cv::Rect(50, 50, 20, 20));
    network.overlap = 1;
    CHECK(network.find(grey_picture({80, 80})).size() == 5);
}

TEST_CASE("network: a model or a file of classes that is not there, or is none, is refused in a sentence")
{
    const onnx::File model(".onnx", onnx::bytes_of(yolo5())), garbage(".onnx", "this is no model"),
        empty(".names", "\n"), binary(".names", std::string(500, 'x'));
    NetworkSettings wanted = settings(model);
    wanted.model = "/nowhere/model.onnx";
    CHECK(refusal(wanted) == "no model at /nowhere/model.onnx");
    wanted.model = "/";
    CHECK(refusal(wanted) == "no model at /");
    CHECK(refusal(settings(garbage)).find("is not an ONNX model") != std::string::npos);
    wanted = settings(model);
    wanted.classes = "/nowhere/classes";
    CHECK(refusal(wanted) == "no file of class names at /nowhere/classes");
    CHECK_THROWS_WITH_AS(detect::class_names("/nowhere/classes"), "no file of class names at /nowhere/classes",
                         std::runtime_error);
    CHECK(detect::class_names("").empty());
    CHECK(refusal(settings(model, &empty)).find("has no class names") != std::string::npos);
    CHECK(refusal(settings(model, &binary)).find("more than 64 bytes") != std::string::npos);
    CHECK(refusal(settings(model)) == "accepted");
}

TEST_CASE("network: a model that does not run with that input, or gives something else, is refused with the shape")
{
    const onnx::File model(".onnx", onnx::bytes_of(yolo5())),
        classifier(".onnx", onnx::bytes_of(constant({1, 10}, std::vector<float>(10)))), names(".names", "a\nb\nc\nd\n");
    CHECK(refusal(settings(classifier)).find("gives 1x10, which is no output of a known detector")
          != std::string::npos);
    CHECK(refusal(settings(model, &names)).find("gives 1x7x7, which is no output of a known detector for the 4 classes")
          != std::string::npos);
    NetworkSettings large = settings(model);
    large.input = {640, 640};
    CHECK(refusal(large).find("does not run with an input of 640x640") != std::string::npos);
}

TEST_CASE("network: the mean is one number or three")
{
    CHECK(detect::mean_from("127.5") == cv::Scalar::all(127.5));
    CHECK(detect::mean_from("104, 177,123") == cv::Scalar(104, 177, 123));
    for (const char* wrong : {"", "1,2", "1,2,3,4", "a", "1,b,3", "1,2,3x", ",,"})
        CHECK_THROWS_AS(detect::mean_from(wrong), std::runtime_error);
}
