// The layouts in which known networks write their objects, and the choice of the one that a network has.
#pragma once

#include <opencv2/core/mat.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace detect {

/// The columns of a table with one object per row. -1: missing.
struct Layout {
    enum class Table {
        rows,
        columns,
        apart,
        lists,
        single
    };  ///< apart: boxes and scores in two; lists: boxes, classes and scores in three; single: scores without boxes
    enum class Box { centre, corners };
    enum class Extra { none, mask, keypoints, angle };  ///< at the end of the row
    enum class Scores { plain, sigmoid, softmax };      ///< the function that maps the numbers to scores from 0 to 1
    enum class Background { none, first, last };        ///< the class that is not an object

    std::string_view name;     ///< as the parameter `layout` has it
    std::string_view outputs;  ///< their shapes, as a person reads them
    Table table = Table::rows;
    int min_sides = 3, max_sides = 3;  ///< of the output
    Box box = Box::corners;
    int box_at = 0;
    bool shares = false;  ///< of the input's sides; else px of the input
    int image_at = -1, objectness_at = -1, score_at = -1, class_at = -1;
    int scores_at = -1;  ///< the first of one score for each class, instead of score_at and class_at
    Extra extra = Extra::none;
    Scores scores = Scores::plain;
    Background background = Background::none;
};

/// All layouts; where two look alike, the one that is tried first comes first.
std::span<const Layout> layouts();
/// @throws std::out_of_range
const Layout& layout_named(std::string_view name);

/// Other information on a network besides its outputs.
struct Knowledge {
    std::size_t classes = 0;  ///< that have names; 0: unknown
    cv::Size input = {};
    std::string task = {};           ///< of Ultralytics: detect, segment, pose, obb, classify; empty: unknown
    int keypoints = 0, numbers = 3;  ///< of an object, and of a keypoint: x, y and perhaps a score; 0: unknown
};

/// A layout, and the outputs in which it is.
struct Place {
    const Layout* layout = nullptr;
    std::size_t boxes = 0, scores = 0;  ///< places in the list of outputs; equal except for Table::apart and lists
    std::size_t class_numbers = 0;      ///< where Layout::class_at is; equal to scores except for Table::lists
    std::size_t prototypes = 0;         ///< of masks
    int classes = 0;                    ///< scores of a row
    int numbers = 3;                    ///< of a keypoint
    bool operator==(const Place&) const = default;
};

/// The layouts that a network with outputs of these shapes may have, the likeliest first.
/// @param wanted  the name of the only layout to consider, also where it is unlikely; empty: any
std::vector<Place> places_in(const std::vector<std::vector<int>>& shapes, const Knowledge& known,
                             std::string_view wanted = {});
/// Why the numbers of these outputs cannot have that layout: scores that are not between 0 and 1, or boxes that are no
/// shares of the input. Nothing if they can.
std::optional<std::string> objection(const std::vector<cv::Mat>& outputs, const Place& place);

/// The output without the sides of 1 at its front, an object a row; without copying, except Table::columns.
cv::Mat table_of(const cv::Mat& output, Layout::Table table);
/// The output that has the scores, or the numbers of the classes, an object a row.
cv::Mat list_of(const cv::Mat& output, Layout::Table table);
/// "1x84x8400"
std::string shape_text(const std::vector<int>& shape);

constexpr double max_score = 1.001;  ///< 1, and what half precision adds to it

}  // namespace detect
