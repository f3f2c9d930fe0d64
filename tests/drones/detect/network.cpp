// Real (tiny) ONNX models through OpenCV's DNN: what they are given, what is made of what they say, and what is
// refused.
#include "onnx_writer.hpp"

#include <doctest/doctest.h>
#include <network.hpp>
#include <onnx_file.hpp>
#include <opencv2/imgproc.hpp>
#include <possible.hpp>

#include <algorithm>
#include <array>

using detect::Network;
using detect::NetworkSettings;

namespace {

/// A model of 8x8 px with this constant output.
onnx::Model constant(std::vector<int> shape, std::vector<float> numbers)
{
    return {.shape = std::move(shape), .constants = std::move(numbers), .wires = {}};
}

/// One object of the first of two classes, left of the middle of the input, in each layout.
onnx::Model yolo5()
{
    std::vector<float> rows(7 * 7);  // as many as numbers in a row, so that its shape suffices without names
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

cv::Mat grey_image(cv::Size size) { return {size, CV_8UC3, cv::Scalar::all(50)}; }

}  // namespace

TEST_CASE("network: each layout of a model is detected, with its box in the right place")
{
    const onnx::File names(".names", "cup\r\nspoon\n\n");
    struct Case {
        onnx::Model model;
        std::string_view layout;
    };
    for (const Case& known : {Case{yolo5(), "yolov5"}, {yolo8(), "yolov8"}, {ssd(), "ssd"}}) {
        const onnx::File model(".onnx", onnx::bytes_of(known.model));
        Network network(settings(model, &names));
        CHECK(network.layout() == known.layout);
        const auto objects = network.find(grey_image({80, 80}));
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
    for (const auto& [known, layout] :
         {std::pair(&apart, std::string_view("ssd-apart")), {&finished, "yolov10"}, {&numbered, "yolov7"}}) {
        CAPTURE(layout);
        const onnx::File model(".onnx", onnx::bytes_of(*known));
        Network network(settings(model, &names));
        CHECK(network.layout() == layout);
        const auto objects = network.find(grey_image({80, 80}));
        REQUIRE(objects.size() == 1);
        CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
        CHECK(objects[0].name == "cup");
        CHECK(objects[0].score == doctest::Approx(0.9));
    }
}

TEST_CASE("network: the size of the input and the names of the classes are read from the model's file, unless set")
{
    onnx::Model model = yolo8();
    model.width = 16;
    model.metadata = {{"names", "{0: 'cup', 1: \"cat's bed\"}"}};
    const onnx::File file(".onnx", onnx::bytes_of(model)), names(".names", "first\nsecond\n");
    NetworkSettings wanted = settings(file);
    wanted.input = {};
    Network network(wanted);
    CHECK(network.input() == cv::Size(16, 8));
    CHECK(network.classes() == 2);
    CHECK(network.find(grey_image({160, 80})).at(0).name == "cup");
    wanted.classes = names.path();
    CHECK(Network(wanted).find(grey_image({160, 80})).at(0).name == "first");
}

TEST_CASE("network: a finished list of a single class is recognized, with its box in the right place")
{
    onnx::Model one = constant({1, 2, 6}, {2, 2, 4, 6, 0.9F, 0, 0, 0, 0, 0, 0, 0});
    one.metadata = {{"names", "{0: 'ball'}"}};
    const onnx::File file(".onnx", onnx::bytes_of(one));
    Network network(settings(file));
    CHECK(network.layout() == "yolov10");
    const auto objects = network.find(grey_image({80, 80}));
    REQUIRE(objects.size() == 1);
    CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
    CHECK(objects[0].name == "ball");
}

TEST_CASE("network: keypoints, oriented boxes and masks are placed in the image")
{
    const auto seen = [](onnx::Model model, const char* task) {
        model.metadata = {{"names", "{0: 'cup'}"}, {"task", task}, {"kpt_shape", "[2, 3]"}};
        const onnx::File file(".onnx", onnx::bytes_of(model));
        return Network(settings(file)).find(grey_image({160, 80})).at(0);  // times 20, without margins of 2
    };
    const auto person = seen(constant({1, 1, 12}, {2, 3, 6, 5, 0.9F, 0, 3, 4, 0.75F, 5, 4, 0.25F}), "pose");
    CHECK(person.box == cv::Rect(40, 20, 80, 40));
    REQUIRE(person.keypoints.size() == 2);
    CHECK(person.keypoints[0].at == cv::Point(60, 40));
    CHECK(person.keypoints[1].score == 0.25);

    const auto ship = seen(constant({1, 1, 7}, {4, 4, 2, 1, 0.9F, 0, static_cast<float>(CV_PI / 2)}), "obb");
    CHECK(ship.box.width == doctest::Approx(20).epsilon(0.06));  // turned by a right angle
    CHECK(ship.box.height == doctest::Approx(40).epsilon(0.06));
    CHECK(ship.corners.size() == 4);

    onnx::Model segmented = constant({1, 1, 8}, {2, 2, 6, 6, 0.9F, 0, 1, -1});
    std::vector<float> prototypes(2 * 64, 0.0F);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            prototypes[static_cast<std::size_t>(x < 4 ? 8 * y + x : 64 + 8 * y + x)] = 1;  // the left half is it
    segmented.more.push_back({"prototypes", {1, 2, 8, 8}, prototypes});
    const auto outline = cv::boundingRect(seen(segmented, "segment").mask);
    CHECK(outline.tl() == cv::Point(40, 0));
    CHECK(outline.br().x <= 81);
    CHECK(outline.br().y >= 60);
}

TEST_CASE("network: oriented boxes that only their upright frames share do not suppress each other")
{
    // Two thin ones side by side, at 45 degrees.
    const auto angle = static_cast<float>(CV_PI / 4);
    onnx::Model model = constant({1, 2, 7}, {4, 3.5F, 6, 0.2F, 0.9F, 0, angle, 4, 4.5F, 6, 0.2F, 0.8F, 0, angle});
    model.metadata = {{"names", "{0: 'ship'}"}, {"task", "obb"}};
    const onnx::File file(".onnx", onnx::bytes_of(model));
    CHECK(Network(settings(file)).find(grey_image({80, 80})).size() == 2);
}

TEST_CASE("network: a classifier gets the middle of the image, and returns its class")
{
    // Its output is its input: the first pixel's red.
    onnx::Model model = constant({1, 2}, {0, 0.1F});
    model.wires = {{0, 0, 1}};
    model.metadata = {{"names", "{0: 'bright', 1: 'dark'}"}, {"task", "classify"}};
    const onnx::File file(".onnx", onnx::bytes_of(model));
    Network network(settings(file));
    cv::Mat image = grey_image({160, 80});
    image(cv::Rect(40, 0, 80, 80)).setTo(cv::Scalar::all(204));  // the middle
    const auto objects = network.find(image);
    REQUIRE(objects.size() == 1);
    CHECK(objects[0].name == "bright");
    CHECK(objects[0].score == doctest::Approx(0.8));
    CHECK(objects[0].box == cv::Rect(40, 0, 80, 80));
}

TEST_CASE("network: a score above 1 is refused, at the first run and later")
{
    onnx::Model model = constant({1, 6, 2}, {3, 0, 4, 0, 2, 0, 4, 0, 0, 0, 0, 0});
    model.wires = {{0, 8, 1}};
    const onnx::File file(".onnx", onnx::bytes_of(model));
    NetworkSettings wanted = settings(file);
    wanted.layout = "yolov8";
    wanted.scale = 1.0 / 120;  // the grey of the first run is below 1
    Network network(wanted);
    CHECK(network.find(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(100))).size() == 1);
    CHECK_THROWS_AS(static_cast<void>(network.find(cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(200)))), std::runtime_error);
    wanted.scale = 1;
    CHECK(refusal(wanted).find("as yolov8 it gives a score of 114, which is not between 0 and 1") != std::string::npos);
}

TEST_CASE("network: an operator that OpenCV lacks is named")
{
    for (const char* operation : {"TopK", "NonMaxSuppression", "GridSample", "Hardmax"}) {
        onnx::Model model = yolo8();
        model.operation = operation;
        const onnx::File file(".onnx", onnx::bytes_of(model));
        NetworkSettings wanted = settings(file);
        wanted.engine = "opencv";
        const std::string sentence = refusal(wanted), expected = "needs " + std::string(operation) + ", which OpenCV";
        CHECK_MESSAGE(sentence.find(expected) != std::string::npos, sentence);
    }
}

TEST_CASE("network: without ONNX Runtime, a model that wants it is refused, and OpenCV is used as before")
{
    onnx::Model model = yolo8();
    model.metadata = {{"names", "{0: 'cup', 1: 'spoon'}"}};
    const onnx::File file(".onnx", onnx::bytes_of(model)), no_library(".so", "this is no library");
    NetworkSettings wanted = settings(file);
    wanted.onnxruntime = no_library.path();
    CHECK(Network(wanted).find(grey_image({80, 80})).size() == 1);
    wanted.engine = "onnxruntime";
    CHECK(refusal(wanted) == file.path() + " cannot be run by ONNX Runtime: no usable " + no_library.path());
}

TEST_CASE("network: each engine gives the same objects, and ONNX Runtime runs what OpenCV cannot (needs ONNX Runtime)")
{
    onnx::Model pose = constant({1, 1, 12}, {2, 3, 6, 5, 0.9F, 0, 3, 4, 0.75F, 5, 4, 0.25F}), two = yolo8();
    pose.metadata = {{"names", "{0: 'cup'}"}, {"task", "pose"}};
    two.metadata = {{"names", "{0: 'cup', 1: 'spoon'}"}};
    onnx::Model seen = two, lacking = two;
    seen.wires = {{0, 8, 0.1F}};  // the score depends on the image
    const auto with = [](const onnx::File& file, const char* engine) {
        NetworkSettings wanted = settings(file);
        wanted.engine = engine;
        return wanted;
    };
    lacking.operation = "Hardmax";
    const onnx::File unknown(".onnx", onnx::bytes_of(lacking));
    if (!hive::test::possible(
            refusal(with(unknown, "onnxruntime")) == "accepted" ? "" : "ONNX Runtime: libonnxruntime.so.1"))
        return;
    CHECK(Network(with(unknown, "auto")).find(grey_image({80, 80})).at(0).box == cv::Rect(20, 20, 20, 40));
    for (const onnx::Model& model : {yolo5(), two, ssd(), pose, seen}) {
        const onnx::File file(".onnx", onnx::bytes_of(model));
        Network one(with(file, "opencv")), other(with(file, "onnxruntime"));
        CHECK(one.layout() == other.layout());
        const auto expected = one.find(grey_image({160, 80})), found = other.find(grey_image({160, 80}));
        REQUIRE(found.size() == expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
            CHECK(found[i].box == expected[i].box);
            CHECK(found[i].name == expected[i].name);
            CHECK(found[i].score == doctest::Approx(expected[i].score));
            CHECK(found[i].keypoints.size() == expected[i].keypoints.size());
        }
    }
    const onnx::File garbage(".onnx", "this is no model");
    CHECK(refusal(with(garbage, "onnxruntime")).find("cannot be run by ONNX Runtime: ") != std::string::npos);
}

TEST_CASE("network: boxes, whole class numbers and scores in three lists, as torchvision's detectors give them")
{
    onnx::Model model = constant({2, 4}, {2, 2, 4, 6, 0, 0, 1, 1});
    model.more = {{"labels", {2}, {1, 0}, true}, {"scores", {2}, {0.9F, 0.1F}}};
    model.metadata = {{"names", "{0: 'cup', 1: 'spoon'}"}};
    const onnx::File file(".onnx", onnx::bytes_of(model));
    Network network(settings(file));
    CHECK(network.layout() == "lists");
    const auto objects = network.find(grey_image({80, 80}));
    REQUIRE(objects.size() == 1);
    CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
    CHECK(objects[0].name == "spoon");
    CHECK(objects[0].score == doctest::Approx(0.9));
}

TEST_CASE(
    "network: RT-DETR's own export has labels of 64 bits, and asks for the size of the image (needs ONNX Runtime)")
{
    onnx::Model model = constant({1, 2, 4}, {0.125F, 0.25F, 0.25F, 0.75F, 0, 0, 0.1F, 0.1F});
    model.width = 16;
    model.sized = true;
    model.more = {{"labels", {1, 2}, {1, 0}, true}, {"scores", {1, 2}, {0.9F, 0.1F}}};
    model.metadata = {{"names", "{0: 'cup', 1: 'spoon'}"}};
    const onnx::File file(".onnx", onnx::bytes_of(model));
    NetworkSettings wanted = settings(file);
    wanted.input = {};
    wanted.engine = "onnxruntime";
    if (!hive::test::possible(refusal(wanted) == "accepted" ? "" : "ONNX Runtime: libonnxruntime.so.1"))
        return;
    for (const char* engine : {"onnxruntime", "auto"}) {
        wanted.engine = engine;
        Network network(wanted);
        CHECK(network.layout() == "lists");
        const auto objects = network.find(grey_image({160, 80}));
        REQUIRE(objects.size() == 1);
        CHECK(objects[0].box == cv::Rect(20, 20, 20, 40));
        CHECK(objects[0].name == "spoon");
        CHECK(objects[0].score == doctest::Approx(0.9));
    }
}

TEST_CASE("network: a configured layout is the only one considered")
{
    const onnx::File file(".onnx", onnx::bytes_of(constant({1, 7, 6}, std::vector<float>(42))));
    NetworkSettings wanted = settings(file);
    CHECK(Network(wanted).layout() == "yolov10");
    wanted.layout = "yolov5";
    CHECK(Network(wanted).layout() == "yolov5");
    wanted.layout = "ssd";
    CHECK(refusal(wanted).find("which is no output of the layout ssd") != std::string::npos);
}

TEST_CASE("model card: damaged, other and missing files give empty fields")
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
    CHECK(detect::model_card(good.path()).operators == std::vector<std::string>{"Flatten", "Gemm", "Reshape"});
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

TEST_CASE("model card: the shape of the keypoints is two numbers that can be")
{
    CHECK(detect::keypoints_from("[17, 3]") == std::pair(17, 3));
    CHECK(detect::keypoints_from("[ 5,2 ]") == std::pair(5, 2));
    for (const char* wrong : {"", "[17]", "[17, 4]", "[-1, 3]", "[17, 3] x", "[100000, 3]", "17, 3"})
        CHECK_FALSE(detect::keypoints_from(wrong));
}

TEST_CASE("network: a wide image is letterboxed or stretched into the input, and its boxes are mapped back")
{
    const onnx::File model(".onnx", onnx::bytes_of(ssd()));
    NetworkSettings wanted = settings(model);
    CHECK(Network(wanted).find(grey_image({160, 80}))[0].box == cv::Rect(40, 0, 40, 80));
    CHECK(Network(wanted).find(grey_image({80, 160}))[0].box == cv::Rect(0, 40, 40, 80));
    wanted.fit = "stretch";
    CHECK(Network(wanted).find(grey_image({160, 80}))[0].box == cv::Rect(40, 20, 40, 40));
    CHECK(Network(wanted).find(cv::Mat(80, 160, CV_8UC1, cv::Scalar(7)))[0].box == cv::Rect(40, 20, 40, 40));
}

TEST_CASE("network: the image reaches the model scaled, without the mean, in the model's order of colours")
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
    wanted.mean = detect::mean_from("102,0,0");
    CHECK(seen().score == doctest::Approx(0.4).epsilon(0.01));
}

TEST_CASE("network: what is not seen well enough is left out")
{
    const onnx::File file(".onnx", onnx::bytes_of(yolo5()));
    Network network(settings(file));
    network.min_score = 0.95;
    CHECK(network.find(grey_image({80, 80})).empty());
    network.min_score = 0.85;
    CHECK(network.find(grey_image({80, 80})).size() == 1);
}

TEST_CASE("network: of overlapping boxes of one class the best is kept; other classes and places are not touched; "
          "boxes end at the image")
{
    const onnx::File file(
        ".onnx",
        onnx::bytes_of(constant({1, 7, 7}, {2,     2,  2,  2,    1, 0.7F, 0, 2.2F, 2, 2,    2, 1, 0.9F, 0, 2, 2, 2,
                                            2,     1,  0,  0.8F, 6, 6,    2, 2,    1, 0.6F, 0, 8, 8,    4, 4, 1, 0,
                                            0.95F, 20, 20, 2,    2, 1,    1, 0,    0, 0,    0, 0, 0,    0, 0})));
    Network network(settings(file));
    const auto objects = network.find(grey_image({80, 80}));
    REQUIRE(objects.size() == 4);
    CHECK(objects[0].box == cv::Rect(60, 60, 20, 20));
    CHECK(objects[1].score == doctest::Approx(0.9));
    CHECK(objects[2].name == "1");
    CHECK(objects[3].box == cv::Rect(50, 50, 20, 20));
    network.overlap = 1;
    CHECK(network.find(grey_image({80, 80})).size() == 5);
}

TEST_CASE("network: a missing or invalid model or class file is refused in a sentence")
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
        features(".onnx", onnx::bytes_of(constant({1, 10, 2, 2}, std::vector<float>(40)))),
        names(".names", "a\nb\nc\nd\n");
    CHECK(refusal(settings(features)).find("gives 1x10x2x2, which is no output of a known detector")
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
