// Detections as CSV, as COCO and as YOLO, the formats that other tools read.
#pragma once

#include <hive/recording/detections.hpp>

#include <map>
#include <string>
#include <vector>

namespace hive::recording {

/// The columns of csv_rows, with a line end.
std::string csv_heading();
/// One line per box, including uncertain tracks; RFC 4180, except for line ends of "\n". An unknown value is empty.
std::string csv_rows(const DetectedImage& image);

/// Images with their certain detections. Several events of one capture are one image.
class Dataset {
public:
    enum class Added { fresh, again, other_capture };
    /// @return  again: more boxes of an image that was already added. other_capture: another capture has this name, as
    /// if a folder is read twice; then nothing is added
    /// @throws Error  refused: the event has no size of its image
    Added add(const DetectedImage& image);

    /// A COCO dataset: `info`, `images`, `categories` and `annotations`. Ids start at 1.
    [[nodiscard]] Json coco() const;
    /// COCO results: `image_id`, `category_id`, `bbox` and `score`; 1 if the drone has none.
    [[nodiscard]] Json coco_results() const;
    /// By name of the file, "street_00000012.txt": a line for each box, category from 0, and its centre and size as
    /// shares of the image. Boxes are cut at the border; those outside are left out.
    /// @throws Error  refused: the names of two images differ only in their extension
    [[nodiscard]] std::map<std::string, std::string> yolo() const;
    /// The categories in the order of their first box.
    [[nodiscard]] const std::vector<std::string>& categories() const { return categories_; }
    [[nodiscard]] std::size_t size() const { return images_.size(); }

private:
    std::size_t category(const std::string& name);

    struct Box {
        Detection detection;
        std::size_t category;  ///< from 0
    };
    struct Image {
        DetectedImage image;
        std::vector<Box> boxes;
    };
    std::vector<Image> images_;
    std::map<std::string, std::size_t> by_name_;
    std::vector<std::string> categories_;
};

}  // namespace hive::recording
