// The detect drone receives images and publishes boxes of people, or of the classes of a model.
#include "network.hpp"
#include "people_finder.hpp"

#include <colours.hpp>
#include <finder_drone.hpp>

#include <cmath>
#include <optional>

namespace {

using detect::Object;

constexpr std::size_t max_header = 56 * 1024;  ///< bytes of all objects; an event's header holds 60 KiB

hive::Json points_json(const std::vector<cv::Point>& points)
{
    hive::Json list = hive::Json::array();
    for (const cv::Point& point : points)
        list.push_back({point.x, point.y});
    return list;
}

hive::Json to_json(const Object& object, const cv::Mat& image)
{
    hive::Json json{{"x", object.box.x},
                    {"y", object.box.y},
                    {"w", object.box.width},
                    {"h", object.box.height},
                    {"class", object.name},
                    {"score", std::round(object.score * 1000) / 1000},
                    {"colours", colours::of(image, object.box)}};
    if (!object.corners.empty())
        json["corners"] = points_json(object.corners);
    if (!object.mask.empty())
        json["mask"] = points_json(object.mask);
    for (const detect::Keypoint& keypoint : object.keypoints)
        json["keypoints"].push_back({keypoint.at.x, keypoint.at.y, std::round(keypoint.score * 100) / 100});
    return json;
}

/// The best objects, as many as an event's header holds.
hive::Json to_header(const std::vector<Object>& objects, const cv::Mat& image)
{
    hive::Json list = hive::Json::array();
    std::size_t bytes = 0;
    for (const Object& object : objects) {
        hive::Json json = to_json(object, image);
        if ((bytes += json.dump().size() + 1) > max_header)
            break;
        list.push_back(std::move(json));
    }
    return {{"objects", std::move(list)}, {"width", image.cols}, {"height", image.rows}};
}

hive::Constraint one_of_the_layouts()
{
    hive::Constraint constraint = hive::one_of({"auto"});
    for (const detect::Layout& layout : detect::layouts())
        constraint.choices.emplace_back(layout.name);
    return constraint;
}

/// The parameters, and the detector that they select.
class Detector {
public:
    void declare(hive::Drone& drone)
    {
        declare_people(drone);
        declare_network(drone);
    }

    /// Loads the detector for the parameters; if that fails, throws the reason and keeps the old one.
    void apply()
    {
        if (people_.stride % 4 != 0)
            throw hive::Error(hive::Errc::refused, "stride is a multiple of 4");
        detect::NetworkSettings wanted = settings_;
        wanted.mean = detect::mean_from(mean_);
        wanted.layout = layout_ == "auto" ? "" : layout_;
        if (wanted.classes != loaded_.classes)
            static_cast<void>(detect::class_names(wanted.classes));  // also without a model
        if (wanted.model.empty())
            network_.reset();
        else if (!network_ || loaded_ != wanted)
            network_ = detect::Network(wanted);  // when it throws, the old one stays
        loaded_ = wanted;
    }

    std::vector<Object> find(const cv::Mat& image)
    {
        if (!network_)
            return people_.find(image);
        network_->min_score = min_score_;
        network_->overlap = overlap_;
        return network_->find(image);
    }

    static hive::Json header(const std::vector<Object>& found, const cv::Mat& image) { return to_header(found, image); }
    static void draw(cv::Mat& canvas, const std::vector<Object>& found) { detect::draw(canvas, found); }

private:
    void declare_people(hive::Drone& drone)
    {
        drone.parameter("hit_threshold", people_.hit_threshold, hive::between(-1, 4),
                        "people: minimum margin of a window; higher finds fewer");
        drone.parameter("enlarge", people_.enlarge, hive::between(1, 4),
                        "people: enlarge the image first, to find smaller people");
        drone.parameter("scale", people_.scale, hive::between(1.01, 2), "people: step between image scales");
        drone.parameter("stride", people_.stride, hive::between(4, 32).in("px"),
                        "people: step between windows, a multiple of 4");
        drone.parameter("padding", people_.padding, hive::between(0, 64).in("px"), "people: padding around the image");
        drone.parameter("grouping", people_.grouping, hive::between(0, 20),
                        "people: number of windows that must agree");
        drone.parameter("shrink", people_.shrink, hive::anything(),
                        "people: remove the margin of the classifier's window from the boxes");
    }

    void declare_network(hive::Drone& drone)
    {
        drone.parameter("model", settings_.model, hive::anything().by_operator(),
                        "ONNX file of a detector; empty: look for people");
        drone.parameter(
            "engine", settings_.engine, hive::one_of({"auto", "opencv", "onnxruntime"}),
            "program that runs the model; auto: OpenCV, and ONNX Runtime for a model that OpenCV cannot run");
        drone.parameter("onnxruntime", settings_.onnxruntime, hive::anything().by_operator(),
                        "path of libonnxruntime.so; empty: found by the dynamic linker");
        drone.parameter("classes", settings_.classes, hive::anything().by_operator(),
                        "class name file, one per line; empty: the names in the model file, or numbers");
        drone.parameter("layout", layout_, one_of_the_layouts(),
                        "format of the model's output; auto: detected from its outputs");
        drone.parameter("input_width", settings_.input.width, hive::between(0, 4096).in("px"),
                        "width of the model's input; 0: as in its file, or else 640");
        drone.parameter("input_height", settings_.input.height, hive::between(0, 4096).in("px"),
                        "height of the model's input; 0: as in its file, or else 640");
        drone.parameter("fit", settings_.fit, hive::one_of({"auto", "letterbox", "stretch", "crop"}),
                        "how to fit an image into the model's input; auto: crop for a classifier, else letterbox");
        drone.parameter("input_scale", settings_.scale, hive::between(0, 255),
                        "the model sees (pixel - mean) times this");
        drone.parameter("mean", mean_, hive::anything(), "one number, or three in the model's order of colours");
        drone.parameter("swap", settings_.swap, hive::anything(), "the model takes RGB instead of BGR");
        drone.parameter("min_score", min_score_, hive::between(0, 1), "minimum score of the model's objects");
        drone.parameter("overlap", overlap_, hive::between(0, 1),
                        "model: drop a box that overlaps a better one of its class by more than this");
    }

    detect::PeopleFinder people_;
    detect::NetworkSettings settings_, loaded_;
    std::string mean_ = "0", layout_ = "auto";
    double min_score_ = 0.5, overlap_ = 0.45;
    std::optional<detect::Network> network_;
};

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"detect", "Finds people, or the classes of an ONNX model, in images."},
                           [](hive::Drone& drone) {
                               finder_drone::run(drone, Detector(),
                                                 {.input = "image",
                                                  .input_help = "images to search for objects",
                                                  .output = "objects",
                                                  .output_help = "the boxes, in the header; no body",
                                                  .annotated_help = "the image with boxes around the objects"});
                           });
}
