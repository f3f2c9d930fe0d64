// Converts tables of numbers to boxes.
#include "model_output.hpp"

#include <algorithm>
#include <cmath>

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

std::vector<Candidate> from_corners(const cv::Mat& table, cv::Size input, double min_score)
{
    std::vector<Candidate> found;
    for (int row = 0; row < table.rows; ++row) {
        const float* numbers = table.ptr<float>(row);
        const cv::Point2d first(numbers[3] * input.width, numbers[4] * input.height),
            last(numbers[5] * input.width, numbers[6] * input.height);
        if (numbers[0] >= 0 && numbers[2] >= min_score)  // SSD fills up its table with an image of -1
            found.push_back({{first, last}, static_cast<int>(numbers[1]), numbers[2]});
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

std::optional<Layout> layout_of(const std::vector<int>& shape, std::size_t classes)
{
    if (shape.size() == 4 && shape[0] == 1 && shape[1] == 1 && shape[3] == 7)
        return Layout::corners;
    if (shape.size() != 3 || shape[0] != 1)
        return std::nullopt;
    const int across = shape[2], down = shape[1], named = static_cast<int>(classes);
    if (classes > 0 ? across == 5 + named : across <= down && across > 5)
        return Layout::rows;
    if (classes > 0 ? down == 4 + named : down < across && down > 4)
        return Layout::columns;
    return std::nullopt;
}

std::string shape_text(const std::vector<int>& shape)
{
    std::string text;
    for (const int side : shape)
        text += (text.empty() ? "" : "x") + std::to_string(side);
    return text;
}

std::vector<Candidate> candidates(const cv::Mat& output, Layout layout, cv::Size input, double min_score)
{
    const int down = output.size[output.dims - 2], across = output.size[output.dims - 1];
    const cv::Mat table = output.reshape(1, {down, across});
    std::vector<Candidate> found;
    switch (layout) {
    case Layout::rows: found = from_rows(table, 5, min_score); break;
    case Layout::columns: found = from_rows(table.t(), 4, min_score); break;
    case Layout::corners: found = from_corners(table, input, min_score); break;
    }
    std::erase_if(found, [](const Candidate& candidate) { return !usable(candidate); });
    return found;
}

}  // namespace detect
