// Converts tables of numbers to boxes.
#include "model_output.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace detect {
namespace {

/// Centre and size, as both kinds of YOLO write a box.
cv::Rect2d around(const float* place)
{
    return {place[0] - place[2] / 2.0, place[1] - place[3] / 2.0, place[2], place[3]};
}

/// One object a row: 4 numbers of its place, `before_classes` - 4 others, then the scores of the classes.
std::vector<Candidate> from_rows(const cv::Mat& table, int before_classes, double min_score)
{
    std::vector<Candidate> found;
    for (int row = 0; row < table.rows; ++row) {
        const float* numbers = table.ptr<float>(row);
        const float* best = std::max_element(numbers + before_classes, numbers + table.cols);
        const double score = before_classes == 5 ? static_cast<double>(numbers[4]) * *best : *best;
        if (score >= min_score)
            found.push_back({around(numbers), static_cast<int>(best - numbers) - before_classes, score});
    }
    return found;
}

/// The number of a class is a float like the others; one that is none becomes -1.
int class_from(float number) { return number >= 0 && number < 1e6F ? static_cast<int>(number) : -1; }

cv::Rect2d between(const float* corners, double across, double down)
{
    return {cv::Point2d(corners[0] * across, corners[1] * down),
            cv::Size2d((corners[2] - corners[0]) * across, (corners[3] - corners[1]) * down)};
}

std::vector<Candidate> from_corners(const cv::Mat& table, cv::Size input, double min_score)
{
    std::vector<Candidate> found;
    for (int row = 0; row < table.rows; ++row) {
        const float* numbers = table.ptr<float>(row);
        if (numbers[0] >= 0 && numbers[2] >= min_score)  // SSD fills up its table with an image of -1
            found.push_back({between(numbers + 3, input.width, input.height), class_from(numbers[1]), numbers[2]});
    }
    return found;
}

/// Corners in px, `score` and `class_index` at these places of a row.
std::vector<Candidate> from_finished(const cv::Mat& table, int corners, int score, int class_index, double min_score)
{
    std::vector<Candidate> found;
    for (int row = 0; row < table.rows; ++row) {
        const float* numbers = table.ptr<float>(row);
        if (numbers[score] >= min_score)
            found.push_back({between(numbers + corners, 1, 1), class_from(numbers[class_index]), numbers[score]});
    }
    return found;
}

/// The first score is that of the background, which is no object.
std::vector<Candidate> from_apart(const cv::Mat& boxes, const cv::Mat& scores, cv::Size input, double min_score)
{
    std::vector<Candidate> found;
    for (int row = 0; row < boxes.rows; ++row) {
        const float *numbers = scores.ptr<float>(row), *best = std::max_element(numbers + 1, numbers + scores.cols);
        if (*best >= min_score)
            found.push_back(
                {between(boxes.ptr<float>(row), input.width, input.height), static_cast<int>(best - numbers), *best});
    }
    return found;
}

bool usable(const Candidate& candidate)
{
    const cv::Rect2d& box = candidate.box;
    const auto sane = [](double value) { return std::isfinite(value) && std::abs(value) < 1e6; };
    return sane(box.x) && sane(box.y) && sane(box.width) && sane(box.height) && box.width > 0 && box.height > 0
           && candidate.class_index >= 0;
}

}  // namespace

namespace {

using Shape = std::vector<int>;

constexpr std::array<std::pair<Layout, std::string_view>, 6> names{{{Layout::rows, "yolov5"},
                                                                    {Layout::columns, "yolov8"},
                                                                    {Layout::corners, "ssd"},
                                                                    {Layout::finished, "yolov10"},
                                                                    {Layout::numbered, "yolov7"},
                                                                    {Layout::apart, "ssd-apart"}}};
constexpr int most_finished = 1000;

/// Without the ones at its front: what is left is a table.
bool is_table(const Shape& shape)
{
    return shape.size() >= 2 && std::all_of(shape.begin(), shape.end() - 2, [](int side) { return side == 1; });
}

/// May an output of this shape have this layout? `told`: somebody said that it has.
bool may_be(Layout layout, const Shape& shape, int classes, bool told)
{
    const int down = shape[shape.size() - 2], across = shape.back();
    const bool three = shape.size() == 3;
    switch (layout) {
    case Layout::rows: return three && (classes > 0 ? across == 5 + classes : across > 5 && (told || across <= down));
    case Layout::columns: return three && (classes > 0 ? down == 4 + classes : down > 4 && (told || down < across));
    case Layout::corners: return shape.size() == 4 && across == 7;
    case Layout::finished: return shape.size() <= 3 && across == 6 && (told || (classes != 1 && down <= most_finished));
    case Layout::numbered: return shape.size() == 2 && across == 7;
    case Layout::apart: return false;  // needs two
    }
    return false;
}

/// Boxes and scores in two outputs of as many rows; of four numbers each, the boxes come first.
std::optional<Place> apart_in(const std::vector<Shape>& shapes, int classes)
{
    for (std::size_t boxes = 0; boxes < shapes.size(); ++boxes)
        for (std::size_t scores = 0; scores < shapes.size(); ++scores) {
            const Shape &place = shapes[boxes], &score = shapes[scores];
            if (boxes != scores && is_table(place) && is_table(score) && place.back() == 4 && score.back() >= 2
                && (classes == 0 || score.back() == classes) && place[place.size() - 2] == score[score.size() - 2])
                return Place{Layout::apart, boxes, scores};
        }
    return std::nullopt;
}

}  // namespace

std::string_view name_of(Layout layout)
{
    return std::ranges::find(names, layout, &decltype(names)::value_type::first)->second;
}

std::optional<Place> layout_of(const std::vector<Shape>& shapes, std::size_t classes, std::string_view wanted)
{
    const int named = static_cast<int>(classes);
    const auto considered = [&](Layout layout) { return wanted.empty() || wanted == name_of(layout); };
    // What only one kind of network gives comes before what looks alike.
    for (const Layout layout :
         {Layout::corners, Layout::numbered, Layout::finished, Layout::apart, Layout::rows, Layout::columns}) {
        if (!considered(layout))
            continue;
        if (layout == Layout::apart) {
            if (const auto place = apart_in(shapes, named))
                return place;
            continue;
        }
        for (std::size_t i = 0; i < shapes.size(); ++i)
            if (is_table(shapes[i]) && may_be(layout, shapes[i], named, !wanted.empty()))
                return Place{layout, i, i};
    }
    return std::nullopt;
}

std::string shape_text(const std::vector<int>& shape)
{
    std::string text;
    for (const int side : shape)
        text += (text.empty() ? "" : "x") + std::to_string(side);
    return text;
}

std::vector<Candidate> candidates(const std::vector<cv::Mat>& outputs, const Place& place, cv::Size input,
                                  double min_score)
{
    const auto table = [&](std::size_t index) {
        const cv::Mat& output = outputs[index];
        return output.reshape(1, {output.size[output.dims - 2], output.size[output.dims - 1]});
    };
    const cv::Mat boxes = table(place.boxes);
    std::vector<Candidate> found;
    switch (place.layout) {
    case Layout::rows: found = from_rows(boxes, 5, min_score); break;
    case Layout::columns: found = from_rows(boxes.t(), 4, min_score); break;
    case Layout::corners: found = from_corners(boxes, input, min_score); break;
    case Layout::finished: found = from_finished(boxes, 0, 4, 5, min_score); break;
    case Layout::numbered: found = from_finished(boxes, 1, 6, 5, min_score); break;
    case Layout::apart: found = from_apart(boxes, table(place.scores), input, min_score); break;
    }
    std::erase_if(found, [](const Candidate& candidate) { return !usable(candidate); });
    return found;
}

}  // namespace detect
