// Applies OpenCV's subtractors, then morphology, then finds connected parts.
#include "foreground_finder.hpp"

#include "light.hpp"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <stdexcept>
#include <tuple>

namespace background {
namespace {

cv::Ptr<cv::BackgroundSubtractor> make(const ModelSettings& settings)
{
    const auto threshold = [&](double usual) { return settings.threshold > 0 ? settings.threshold : usual; };
    if (settings.method == "mog2")
        return cv::createBackgroundSubtractorMOG2(settings.history, threshold(16), settings.shadows);
    if (settings.method == "knn")
        return cv::createBackgroundSubtractorKNN(settings.history, threshold(400), settings.shadows);
    throw std::invalid_argument("no method " + settings.method + "; there are mog2 and knn");
}

/// By default a new mixture learns a thing that stays for a few frames as background; at a constant rate this takes a
/// tenth of the history from the start. The samples of knn must first be filled quickly.
double learning_rate(const ModelSettings& settings) { return settings.method == "mog2" ? 1.0 / settings.history : -1; }

constexpr int renewal = 25;  ///< images in which the known background hardly changes
constexpr int settled = 50;  ///< images after which KNN learns slowly enough

cv::Mat disc(int radius) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}); }

}  // namespace

Foreground ForegroundFinder::find(const cv::Mat& image)
{
    if (!subtractor_ || model != started_with_ || image.size() != size_ || image.type() != type_)
        begin(image);
    Foreground result;
    subtractor_->apply(image, result.mask, learning_rate(model));
    if (learned_ >= young && relight(image, result.mask)) {
        subtractor_->apply(image, result.mask, learning_rate(model));
        result.light_changed = true;
    }
    result.learned = ++learned_;
    if (learned_ <= young)
        result.mask.setTo(0);  // the background is hardly known yet
    tidy(result.mask);
    result.blobs = blobs_of(result.mask);
    return result;
}

void ForegroundFinder::begin(const cv::Mat& image)
{
    subtractor_ = make(model);
    started_with_ = model;
    size_ = image.size();
    type_ = image.type();
    learned_ = 0;
    known_.release();
}

/// If the light has changed, restarts the model with its known background in the new light, so that things in front of
/// it stay foreground. (OpenCV's KNN does not return the background of grey images.) Small copies detect a change; the
/// full background is computed only for one. The small background is kept, because much foreground may stay for long.
bool ForegroundFinder::relight(const cv::Mat& image, const cv::Mat& mask)
{
    const bool has_background = model.method == "mog2" || image.channels() == 3;
    if (!has_background || 100.0 * cv::countNonZero(mask == foreground) <= light * static_cast<double>(mask.total()))
        return false;
    cv::Mat known, ignored;
    if (known_.empty() || learned_ - known_at_ >= renewal) {
        subtractor_->getBackgroundImage(known);
        known_ = reduced(known);
        known_at_ = learned_;
    }
    const auto gains = change_of_light(reduced(image), known_);
    if (!gains)
        return false;
    subtractor_->getBackgroundImage(known);
    const cv::Mat lit = in_the_light(known, *gains);
    known_.release();
    subtractor_ = make(model);
    // From one image a mixture assumes large noise, which is fine. A young KNN would learn anything that stays briefly.
    for (int i = 0; i < (model.method == "mog2" ? 1 : settled); ++i)
        subtractor_->apply(lit, ignored, learning_rate(model));
    return true;
}

/// Filters only the foreground; shadows remain where the foreground does not cover them.
void ForegroundFinder::tidy(cv::Mat& mask) const
{
    if (open == 0 && close == 0)
        return;
    cv::Mat things = mask == foreground;
    if (open > 0)
        cv::morphologyEx(things, things, cv::MORPH_OPEN, disc(open));
    if (close > 0)
        cv::morphologyEx(things, things, cv::MORPH_CLOSE, disc(close));
    mask.setTo(0, mask == foreground);
    mask.setTo(foreground, things);
}

std::vector<Blob> ForegroundFinder::blobs_of(const cv::Mat& mask) const
{
    cv::Mat labels, rows, middles;
    const int count = cv::connectedComponentsWithStats(mask == foreground, labels, rows, middles);
    std::vector<Blob> blobs;
    for (int i = 1; i < count; ++i) {  // 0 is the background
        const int* row = rows.ptr<int>(i);
        if (row[cv::CC_STAT_AREA] >= min_area)
            blobs.push_back(
                {{row[cv::CC_STAT_LEFT], row[cv::CC_STAT_TOP], row[cv::CC_STAT_WIDTH], row[cv::CC_STAT_HEIGHT]},
                 row[cv::CC_STAT_AREA]});
    }
    const auto place = [](const Blob& blob) {
        return std::tuple(blob.box.y, blob.box.x, blob.box.height, blob.box.width);
    };
    if (blobs.size() > max_blobs) {
        std::ranges::sort(blobs, {}, [&](const Blob& blob) { return std::tuple(-blob.area, place(blob)); });
        blobs.resize(max_blobs);
    }
    std::ranges::sort(blobs, {}, place);
    return blobs;
}

}  // namespace background
