#include "model_output.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace detect {
namespace {

struct Best {
    int class_index = -1;
    double score = 0;
};

/// The number of a class is a float like the others; an invalid one becomes -1.
int class_from(float number) { return number >= 0 && number < 1e6F ? static_cast<int>(number) : -1; }

double score_from(const float* numbers, int classes, int index, Layout::Scores kind)
{
    const double number = numbers[index];
    if (kind == Layout::Scores::plain)
        return number;
    if (kind == Layout::Scores::sigmoid)
        return 1 / (1 + std::exp(-number));
    const double sum = std::accumulate(numbers, numbers + classes, 0.0,
                                       [&](double all, double other) { return all + std::exp(other - number); });
    return 1 / sum;
}

Best best_of(const float* row, const float* class_numbers, const Place& place)
{
    const Layout& layout = *place.layout;
    if (layout.class_at >= 0)
        return {class_from(class_numbers[layout.class_at]), row[layout.score_at]};
    const float* scores = row + layout.scores_at;
    const int first = layout.background == Layout::Background::first ? 1 : 0,
              end = place.classes - (layout.background == Layout::Background::last ? 1 : 0);
    const int best = static_cast<int>(std::max_element(scores + first, scores + end) - scores);
    const double objectness = layout.objectness_at >= 0 ? row[layout.objectness_at] : 1;
    return {best, objectness * score_from(scores, place.classes, best, layout.scores)};
}

cv::Rect2d box_from(const float* row, const Layout& layout, cv::Size input)
{
    const float* numbers = row + layout.box_at;
    const double across = layout.shares ? input.width : 1, down = layout.shares ? input.height : 1;
    const double x = numbers[0] * across, y = numbers[1] * down, third = numbers[2] * across,
                 fourth = numbers[3] * down;
    if (layout.box == Layout::Box::centre)
        return {x - third / 2, y - fourth / 2, third, fourth};
    return {cv::Point2d(x, y), cv::Size2d(third - x, fourth - y)};
}

/// The values after box and class in a row.
void add_extra(Candidate& candidate, const float* row, int across, const Place& place)
{
    const Layout& layout = *place.layout;
    const int start = layout.class_at >= 0 ? layout.class_at + 1 : layout.scores_at + place.classes;
    if (layout.extra == Layout::Extra::angle)
        candidate.angle = row[start];
    else if (layout.extra != Layout::Extra::none)
        candidate.extra.assign(row + start, row + across);
}

bool usable(const Candidate& candidate)
{
    const cv::Rect2d& box = candidate.box;
    const auto sane = [](double value) { return std::isfinite(value) && std::abs(value) < 1e6; };
    return sane(box.x) && sane(box.y) && sane(box.width) && sane(box.height) && box.width > 0 && box.height > 0
           && sane(candidate.angle) && std::ranges::all_of(candidate.extra, sane) && candidate.class_index >= 0;
}

/// Each class of the whole image.
std::vector<Candidate> classes_of(const float* scores, const Place& place, cv::Size input)
{
    std::vector<Candidate> found;
    for (int i = 0; i < place.classes; ++i)
        found.push_back({.box = cv::Rect2d({}, cv::Size2d(input)),
                         .class_index = i,
                         .score = score_from(scores, place.classes, i, place.layout->scores)});
    return found;
}

std::vector<Candidate> rows_of(const std::vector<cv::Mat>& outputs, const Place& place, cv::Size input,
                               double min_score)
{
    const Layout& layout = *place.layout;
    const cv::Mat boxes = table_of(outputs[place.boxes], layout.table),
                  scores = place.scores == place.boxes ? boxes : list_of(outputs[place.scores], layout.table),
                  class_numbers = place.class_numbers == place.scores
                                      ? scores
                                      : list_of(outputs[place.class_numbers], layout.table);
    std::vector<Candidate> found;
    for (int row = 0; row < boxes.rows; ++row) {
        const float* numbers = boxes.ptr<float>(row);
        const Best best = best_of(scores.ptr<float>(row), class_numbers.ptr<float>(row), place);
        if (best.score < min_score || (layout.image_at >= 0 && numbers[layout.image_at] < 0))
            continue;  // SSD fills up its table with rows of image -1
        Candidate candidate{
            .box = box_from(numbers, layout, input), .class_index = best.class_index, .score = best.score};
        add_extra(candidate, numbers, boxes.cols, place);
        found.push_back(std::move(candidate));
    }
    return found;
}

}  // namespace

std::vector<Candidate> candidates(const std::vector<cv::Mat>& outputs, const Place& place, cv::Size input,
                                  double min_score)
{
    std::vector<Candidate> found = place.layout->table == Layout::Table::single
                                       ? classes_of(outputs[place.scores].ptr<float>(), place, input)
                                       : rows_of(outputs, place, input, min_score);
    std::erase_if(found, [&](const Candidate& one) { return !usable(one) || !(one.score >= min_score); });
    for (const Candidate& candidate : found)
        if (candidate.score > max_score)
            throw std::runtime_error("the model returns a score of " + std::to_string(candidate.score)
                                     + ", above 1: its layout is not " + std::string(place.layout->name));
    return found;
}

}  // namespace detect
