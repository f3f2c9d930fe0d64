#include "layouts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

namespace detect {
namespace {

using Shape = std::vector<int>;
using Table = Layout::Table;
using Box = Layout::Box;
using Extra = Layout::Extra;
using Scores = Layout::Scores;
using Background = Layout::Background;

// Sources. YOLOv5 and v7: export.py of their repositories. YOLOv8 to YOLO26: ultralytics/nn/modules/head.py (Detect,
// Segment, Pose, OBB: forward and postprocess; RTDETRDecoder) and NMSModel in ultralytics/engine/exporter.py. SSD: the
// layer DetectionOutput of Caffe, and the ONNX model zoo. YOLO-NAS: super-gradients' convert_to_onnx. DETR and RT-DETR:
// the outputs logits and pred_boxes of Hugging Face's transformers. Lists: export_onnx.py of RT-DETR and D-FINE, and
// the detection models of torchvision.
constexpr std::array known_layouts{
    Layout{.name = "ssd",
           .outputs = "1x1xNx7",
           .min_sides = 4,
           .max_sides = 4,
           .box_at = 3,
           .shares = true,
           .image_at = 0,
           .score_at = 2,
           .class_at = 1},
    Layout{.name = "yolov7",
           .outputs = "Nx7",
           .min_sides = 2,
           .max_sides = 2,
           .box_at = 1,
           .image_at = 0,
           .score_at = 6,
           .class_at = 5},
    Layout{
        .name = "yolo26-seg", .outputs = "1xNx(6+M) and 1xMxHxW", .score_at = 4, .class_at = 5, .extra = Extra::mask},
    Layout{
        .name = "yolo26-pose", .outputs = "1xNx(6+keypoints)", .score_at = 4, .class_at = 5, .extra = Extra::keypoints},
    Layout{.name = "yolo26-obb",
           .outputs = "1xNx7",
           .box = Box::centre,
           .score_at = 4,
           .class_at = 5,
           .extra = Extra::angle},
    Layout{.name = "yolov8-seg",
           .outputs = "1x(4+classes+M)xN and 1xMxHxW",
           .table = Table::columns,
           .box = Box::centre,
           .scores_at = 4,
           .extra = Extra::mask},
    Layout{.name = "yolov8-pose",
           .outputs = "1x(4+classes+keypoints)xN",
           .table = Table::columns,
           .box = Box::centre,
           .scores_at = 4,
           .extra = Extra::keypoints},
    Layout{.name = "yolov8-obb",
           .outputs = "1x(5+classes)xN",
           .table = Table::columns,
           .box = Box::centre,
           .scores_at = 4,
           .extra = Extra::angle},
    Layout{.name = "yolov5-seg",
           .outputs = "1xNx(5+classes+M) and 1xMxHxW",
           .box = Box::centre,
           .objectness_at = 4,
           .scores_at = 5,
           .extra = Extra::mask},
    Layout{.name = "yolov10", .outputs = "1xNx6", .min_sides = 2, .score_at = 4, .class_at = 5},
    Layout{.name = "lists",
           .outputs = "1xNx4, 1xN and 1xN",
           .table = Table::lists,
           .min_sides = 2,
           .score_at = 0,
           .class_at = 0},
    Layout{.name = "ssd-apart",
           .outputs = "1xNx4 and 1xNxclasses",
           .table = Table::apart,
           .min_sides = 2,
           .max_sides = 4,
           .shares = true,
           .scores_at = 0,
           .background = Background::first},
    Layout{.name = "yolo-nas", .outputs = "1xNx4 and 1xNxclasses", .table = Table::apart, .scores_at = 0},
    Layout{.name = "detr",
           .outputs = "1xNx4 and 1xNx(classes+1)",
           .table = Table::apart,
           .box = Box::centre,
           .shares = true,
           .scores_at = 0,
           .scores = Scores::softmax,
           .background = Background::last},
    Layout{.name = "rt-detr-apart",
           .outputs = "1xNx4 and 1xNxclasses",
           .table = Table::apart,
           .box = Box::centre,
           .shares = true,
           .scores_at = 0,
           .scores = Scores::sigmoid},
    Layout{.name = "rt-detr", .outputs = "1xNx(4+classes)", .box = Box::centre, .shares = true, .scores_at = 4},
    Layout{.name = "yolov5", .outputs = "1xNx(5+classes)", .box = Box::centre, .objectness_at = 4, .scores_at = 5},
    Layout{.name = "yolov8", .outputs = "1x(4+classes)xN", .table = Table::columns, .box = Box::centre, .scores_at = 4},
    Layout{.name = "classify",
           .outputs = "1xclasses",
           .table = Table::single,
           .min_sides = 2,
           .max_sides = 2,
           .scores_at = 0},
    Layout{.name = "classify-logits",
           .outputs = "1xclasses",
           .table = Table::single,
           .min_sides = 2,
           .max_sides = 2,
           .scores_at = 0,
           .scores = Scores::softmax},
};

constexpr int max_listed = 1000;  ///< no suppression leaves more, and hardly any network has fewer places
constexpr double max_share = 16;  ///< of a box in shares; boxes in px reach further

int rows_of(const Shape& shape) { return shape[shape.size() - 2]; }

/// Without leading sides of 1: the rest is a table.
bool is_table(const Shape& shape)
{
    return shape.size() >= 2 && std::all_of(shape.begin(), shape.end() - 2, [](int side) { return side == 1; });
}

bool is_list(const Shape& shape, int length)
{
    return is_table(shape) && std::min(rows_of(shape), shape.back()) <= 1 && rows_of(shape) * shape.back() == length;
}

/// The number of places at which YOLOv5 and v7 look: three at every 8th, 16th, 32nd (and 64th) pixel; tiny ones not
/// at every 8th.
bool is_grid(int rows, cv::Size input)
{
    const auto at_every = [&](int step) { return 3 * (input.width / step) * (input.height / step); };
    const int tiny = at_every(16) + at_every(32), usual = at_every(8) + tiny;
    return rows == tiny || rows == usual || rows == usual + at_every(64);
}

Extra extra_of(const std::string& task)
{
    return task == "segment" ? Extra::mask
           : task == "pose"  ? Extra::keypoints
           : task == "obb"   ? Extra::angle
                             : Extra::none;
}

/// Searches for one layout among the outputs.
class Search {
public:
    Search(const Layout& layout, const std::vector<Shape>& shapes, const Knowledge& known, bool told)
        : layout_(layout), shapes_(shapes), known_(known), fixed_(told), named_(static_cast<int>(known.classes))
    {
    }

    std::optional<Place> place() const
    {
        if (!fixed_ && !suits_the_task())
            return std::nullopt;
        for (std::size_t i = 0; i < shapes_.size(); ++i)
            if (const auto found = layout_.table == Table::apart   ? in_two(i)
                                   : layout_.table == Table::lists ? in_three(i)
                                                                   : in_one(i))
                return found;
        return std::nullopt;
    }

private:
    /// Masks are recognizable by the outputs; keypoints and angles only by the task.
    bool suits_the_task() const
    {
        if (known_.task.empty())
            return layout_.extra == Extra::none || layout_.extra == Extra::mask;
        return layout_.extra == extra_of(known_.task)
               && (layout_.table == Table::single) == (known_.task == "classify");
    }

    bool has_sides(const Shape& shape) const
    {
        const int sides = static_cast<int>(shape.size());
        return is_table(shape) && sides >= layout_.min_sides && sides <= layout_.max_sides;
    }

    std::optional<Place> in_one(std::size_t index) const
    {
        const Shape& shape = shapes_[index];
        if (!has_sides(shape))
            return std::nullopt;
        Place place{.layout = &layout_, .boxes = index, .scores = index, .class_numbers = index};
        if (layout_.table == Table::single)
            return of_scores(place);
        const bool columns_are_rows = layout_.table == Table::columns;
        const int across = columns_are_rows ? rows_of(shape) : shape.back(),
                  down = columns_are_rows ? shape.back() : rows_of(shape);
        const auto extra = numbers_of_extra(across, place);
        if (!extra)
            return std::nullopt;
        return layout_.scores_at >= 0 ? with_classes(place, across - *extra, across, down)
                                      : listed(place, across - *extra, down);
    }

    std::optional<Place> of_scores(Place place) const
    {
        const Shape& shape = shapes_[place.scores];
        place.classes = shape.back();
        const bool fits = named_ > 0 ? shape.back() == named_ : shape.back() >= 2;
        return shape[0] == 1 && shapes_.size() == 1 && fits ? std::optional(place) : std::nullopt;
    }

    std::optional<Place> listed(const Place& place, int across, int down) const
    {
        const int numbers = std::max({layout_.box_at + 4, layout_.score_at + 1, layout_.class_at + 1});
        const bool may_be_yolov5 = numbers == 6 && layout_.extra == Extra::none;
        const bool may_be_classes = down == 1 && named_ == across;  // of one image
        const bool likely =
            !may_be_classes && (!may_be_yolov5 || (down <= max_listed && (named_ > 1 || !is_grid(down, known_.input))));
        return across == numbers && (fixed_ || likely) ? std::optional(place) : std::nullopt;
    }

    /// Without names, the shorter side of the table is one object.
    std::optional<Place> with_classes(Place place, int across, int whole, int down) const
    {
        place.classes = across - layout_.scores_at;
        const bool likely = !layout_.shares && (layout_.table == Table::columns ? whole < down : whole <= down);
        const bool fits = named_ > 0 ? place.classes == named_ : place.classes > 0 && (fixed_ || likely);
        return fits ? std::optional(place) : std::nullopt;
    }

    /// The number of values in a row after a box and its class.
    std::optional<int> numbers_of_extra(int across, Place& place) const
    {
        switch (layout_.extra) {
        case Extra::none: return 0;
        case Extra::angle: return 1;
        case Extra::mask: return prototypes(place);
        case Extra::keypoints: break;
        }
        const int others = layout_.scores_at >= 0 ? layout_.scores_at + std::max(named_, 1) : layout_.class_at + 1;
        const int left = across - others;
        place.numbers = known_.numbers;
        if (left <= 0 || left % known_.numbers != 0
            || (known_.keypoints > 0 && left != known_.keypoints * known_.numbers))
            return std::nullopt;
        return left;
    }

    /// 1 x M x H x W
    std::optional<int> prototypes(Place& place) const
    {
        for (std::size_t i = 0; i < shapes_.size(); ++i)
            if (const Shape& shape = shapes_[i]; shape.size() == 4 && shape[0] == 1 && !is_table(shape)) {
                place.prototypes = i;
                return shape[1];
            }
        return std::nullopt;
    }

    /// As many rows; of four numbers each, the boxes come first.
    std::optional<Place> in_two(std::size_t boxes) const
    {
        const Shape& place = shapes_[boxes];
        if (!has_sides(place) || place.back() != 4)
            return std::nullopt;
        for (std::size_t scores = 0; scores < shapes_.size(); ++scores)
            if (const Shape& score = shapes_[scores];
                scores != boxes && has_sides(score) && rows_of(score) == rows_of(place) && fits_classes(score.back()))
                return Place{.layout = &layout_, .boxes = boxes, .scores = scores, .classes = score.back()};
        return std::nullopt;
    }

    /// One number per box, twice: in all known networks the classes precede the scores.
    std::optional<Place> in_three(std::size_t boxes) const
    {
        const Shape& place = shapes_[boxes];
        if (!has_sides(place) || place.back() != 4)
            return std::nullopt;
        std::vector<std::size_t> lists;
        for (std::size_t i = 0; i < shapes_.size(); ++i)
            if (i != boxes && is_list(shapes_[i], rows_of(place)))
                lists.push_back(i);
        return lists.size() == 2 ? std::optional(
                   Place{.layout = &layout_, .boxes = boxes, .scores = lists[1], .class_numbers = lists[0]})
                                 : std::nullopt;
    }

    /// Both DETRs have logits, and only the number of names distinguishes them.
    bool fits_classes(int across) const
    {
        const int more = layout_.background == Background::last ? 1 : 0;
        return named_ > 0 ? across == named_ + more : across > more && (fixed_ || layout_.scores == Scores::plain);
    }

    const Layout& layout_;
    const std::vector<Shape>& shapes_;
    const Knowledge& known_;
    bool fixed_;
    int named_;
};

/// A number in some columns that is out of a range.
std::optional<double> beyond(const cv::Mat& numbers, int from, int count, double least, double most)
{
    for (int row = 0; row < numbers.rows; ++row)
        for (int i = from; i < from + count; ++i)
            if (const double number = numbers.at<float>(row, i); number < least || number > most)
                return number;
    return std::nullopt;
}

}  // namespace

std::span<const Layout> layouts() { return known_layouts; }

const Layout& layout_named(std::string_view name)
{
    const auto found = std::ranges::find(known_layouts, name, &Layout::name);
    return found != known_layouts.end() ? *found : throw std::out_of_range("no layout " + std::string(name));
}

std::vector<Place> places_in(const std::vector<Shape>& shapes, const Knowledge& known, std::string_view wanted)
{
    std::vector<Place> places;
    for (const Layout& layout : known_layouts)
        if (wanted.empty() || wanted == layout.name)
            if (const auto place = Search(layout, shapes, known, !wanted.empty()).place())
                places.push_back(*place);
    return places;
}

std::optional<std::string> objection(const std::vector<cv::Mat>& outputs, const Place& place)
{
    const Layout& layout = *place.layout;
    const auto wrong = [&](const char* what, double number, const char* expected) {
        char text[128];
        std::snprintf(text, sizeof text, " %s of %g, %s", what, number, expected);
        return "as " + std::string(layout.name) + " it gives" + text;
    };
    const cv::Mat numbers = list_of(outputs[place.scores], layout.table),
                  classes = list_of(outputs[place.class_numbers], layout.table),
                  boxes = table_of(outputs[place.boxes], layout.table);
    const bool each = layout.scores_at >= 0;
    if (layout.scores == Scores::plain)
        if (const auto score = beyond(numbers, each ? layout.scores_at : layout.score_at, each ? place.classes : 1,
                                      1 - max_score, max_score))
            return wrong("a score", *score, "which is not between 0 and 1");
    if (layout.class_at >= 0)
        for (int row = 0; row < classes.rows; ++row)
            if (const float number = classes.at<float>(row, layout.class_at); number != std::floor(number))
                return wrong("a class", number, "which is not a whole number");
    if (layout.shares)
        if (const auto corner = beyond(boxes, layout.box_at, 4, -max_share, max_share))
            return wrong("a box", *corner, "which is not a share of the input");
    return std::nullopt;
}

cv::Mat table_of(const cv::Mat& output, Layout::Table table)
{
    if (output.total() == 0)  // nothing is seen; reshape() refuses that
        return cv::Mat(0, output.size[output.dims - 1], CV_32F);
    const cv::Mat rows = output.reshape(1, {output.size[output.dims - 2], output.size[output.dims - 1]});
    return table == Table::columns ? cv::Mat(rows.t()) : rows;
}

cv::Mat list_of(const cv::Mat& output, Layout::Table table)
{
    if (table != Table::lists)
        return table_of(output, table);
    return output.total() == 0 ? cv::Mat(0, 1, CV_32F) : output.reshape(1, {static_cast<int>(output.total()), 1});
}

std::string shape_text(const std::vector<int>& shape)
{
    std::string text;
    for (const int side : shape)
        text += (text.empty() ? "" : "x") + std::to_string(side);
    return text;
}

}  // namespace detect
