// Applies OpenCV's subtractors, then morphology, then looks for connected parts.
#include "foreground_finder.hpp"

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

/// By itself a young mixture takes a thing that stays for a few pictures into the background; at an even rate it takes
/// a tenth of the history from the beginning. The samples of knn have to be filled quickly first.
double learning_rate(const ModelSettings& settings) { return settings.method == "mog2" ? 1.0 / settings.history : -1; }

cv::Mat disc(int radius) { return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}); }

}  // namespace

Foreground ForegroundFinder::find(const cv::Mat& picture)
{
    if (!subtractor_ || model != begun_with_ || picture.size() != size_ || picture.type() != type_)
        begin(picture);
    Foreground result;
    subtractor_->apply(picture, result.mask, learning_rate(model));
    result.learned = ++learned_;
    if (learned_ <= young)
        result.mask.setTo(0);  // there is hardly anything yet that it could differ from
    tidy(result.mask);
    result.blobs = blobs_of(result.mask);
    return result;
}

void ForegroundFinder::begin(const cv::Mat& picture)
{
    subtractor_ = make(model);
    begun_with_ = model;
    size_ = picture.size();
    type_ = picture.type();
    learned_ = 0;
}

/// Works on the foreground alone; what stays of the shadows is what the foreground does not cover.
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
    if (blobs.size() > most_blobs) {
        std::ranges::sort(blobs, {}, [&](const Blob& blob) { return std::tuple(-blob.area, place(blob)); });
        blobs.resize(most_blobs);
    }
    std::ranges::sort(blobs, {}, place);
    return blobs;
}

}  // namespace background
