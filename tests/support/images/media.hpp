// Images and files for tests: generated, or from a developer's folder of media.
#pragma once

#include "truth.hpp"

#include <hive/body.hpp>

#include <opencv2/core/mat.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace media {

using Bytes = std::vector<unsigned char>;

/// `$HIVE_SHARED/<name>`, or next to the source tree `../shared/<name>`; nothing if it is missing, and then the test
/// case counts as skipped.
std::optional<std::filesystem::path> shared(const std::string& name);
/// The files of the media folder with one of these suffixes, sorted; empty without one, and then the test case counts
/// as skipped.
std::vector<std::filesystem::path> images(const std::vector<std::string>& suffixes);
std::vector<cv::Rect2d> boxes(const std::vector<TrueBox>& things);
Bytes read(const std::filesystem::path& path);
void write(const std::filesystem::path& path, const Bytes& bytes);

/// An image with gradients, edges and grain.
cv::Mat sample(cv::Size size, int type, int seed = 1);
/// Encoded by OpenCV.
Bytes encoded(const char* suffix, const cv::Mat& image, const std::vector<int>& options = {});
bool same(const cv::Mat& a, const cv::Mat& b);

/// A temporary folder, removed with the object.
class Folder {
public:
    Folder();
    ~Folder();
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace media
