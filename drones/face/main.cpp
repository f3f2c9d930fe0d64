// The face drone receives images, and publishes boxes of frontal faces and annotated images.
#include "face_finder.hpp"
#include "yunet_finder.hpp"

#include <finder_drone.hpp>

#include <cmath>
#include <optional>

namespace {

using face::Face;
using face::FaceFinder;

/// A face of the cascade is a box and nothing else.
hive::Json to_json(const Face& face, bool scored)
{
    hive::Json json{{"x", face.box.x}, {"y", face.box.y}, {"w", face.box.width}, {"h", face.box.height}};
    if (!scored)
        return json;
    json["score"] = std::round(face.score * 1000) / 1000;
    for (const auto& point : face.points)
        json["points"].push_back({std::lround(point.x), std::lround(point.y)});
    return json;
}

/// The parameters, and the detector that they select.
class Detector {
public:
    void declare(hive::Drone& drone)
    {
        drone.parameter("scale", cascades_.scale, hive::between(1.01, 2),
                        "image scale step; smaller finds more but takes longer");
        drone.parameter("min_neighbors", cascades_.min_neighbors, hive::between(0, 100),
                        "detections that must agree on a face");
        drone.parameter("min_size", cascades_.min_size, hive::between(1, 16384).in("px"), "side of the smallest face");
        drone.parameter("max_size", cascades_.max_size, hive::between(0, 16384).in("px"),
                        "side of the largest face; 0: no limit");
        drone.parameter("equalise", cascades_.equalise, hive::anything(), "equalise the grey levels first");
        drone.parameter("cascade", cascade_, hive::anything().by_operator(), "file of the Haar or LBP cascade");
        drone.parameter("yunet", yunet_, hive::anything().by_operator(),
                        "ONNX file of YuNet; empty: the cascade finds faces");
        drone.parameter("min_score", min_score_, hive::between(0, 1), "yunet: minimum face score");
        drone.parameter("overlap", overlap_, hive::between(0, 1),
                        "yunet: drop a face that overlaps a better one by more than this");
    }

    /// Loads the detector for the parameters; if that fails, throws the reason and keeps the old one.
    void apply()
    {
        if (cascades_.max_size != 0 && cascades_.max_size < cascades_.min_size)
            throw hive::Error(hive::Errc::refused, "max_size is smaller than min_size");
        if (cascade_ != loaded_cascade_)
            cascades_.load(cascade_);
        loaded_cascade_ = cascade_;
        if (yunet_.empty())
            network_.reset();
        else if (yunet_ != loaded_yunet_)
            network_ = face::YunetFinder(yunet_);  // loaded first: a failure keeps the old one
        loaded_yunet_ = yunet_;
    }

    std::vector<Face> find(const cv::Mat& image)
    {
        if (network_) {
            network_->min_score = min_score_;
            network_->overlap = overlap_;
            return network_->find(image);
        }
        std::vector<Face> faces;
        for (const cv::Rect& box : cascades_.find(image))
            faces.push_back({.box = box});
        return faces;
    }

    [[nodiscard]] hive::Json header(const std::vector<Face>& found, const cv::Mat& image) const
    {
        hive::Json list = hive::Json::array();
        for (const Face& one : found)
            list.push_back(to_json(one, network_.has_value()));
        return {{"faces", std::move(list)}, {"width", image.cols}, {"height", image.rows}};
    }

    static void draw(cv::Mat& canvas, const std::vector<Face>& found)
    {
        for (const Face& one : found)
            FaceFinder::draw(canvas, {one.box});
    }

private:
    FaceFinder cascades_;
    std::optional<face::YunetFinder> network_;
    std::string cascade_ = face::default_cascade, loaded_cascade_, yunet_, loaded_yunet_;
    double min_score_ = 0.8, overlap_ = 0.3;
};

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"face", "Finds frontal faces in images."}, [](hive::Drone& drone) {
        finder_drone::run(drone, Detector(),
                          {.input = "image",
                           .input_help = "images to search for faces",
                           .output = "faces",
                           .output_help = "the boxes, in the header; no body",
                           .annotated_help = "the image with boxes around the faces"});
    });
}
