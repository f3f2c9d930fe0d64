// From masks and colours to silhouettes.
#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <silhouette.hpp>

#include <vector>

using gesture::Silhouette;

namespace {

cv::Mat row(const std::vector<unsigned char>& levels) { return cv::Mat(levels, true).reshape(1, 1); }

}  // namespace

TEST_CASE("silhouette: a mask is taken from its level on, grey or colour")
{
    const cv::Mat grey = row({0, 1, 127, 255});
    cv::Mat colour;
    cv::merge(std::vector<cv::Mat>{grey, grey, grey}, colour);
    Silhouette silhouette;
    for (const cv::Mat& mask : {grey, colour}) {
        silhouette.level = 1;
        CHECK(cv::norm(silhouette.of(mask), row({0, 255, 255, 255}), cv::NORM_INF) == 0);
        silhouette.level = 128;
        CHECK(cv::norm(silhouette.of(mask), row({0, 0, 0, 255}), cv::NORM_INF) == 0);
    }
}

TEST_CASE("silhouette: skin is in the range, grey walls and blue shirts are not; a grey image has no skin")
{
    Silhouette silhouette;
    silhouette.from = "skin";
    cv::Mat image(1, 3, CV_8UC3);
    image.at<cv::Vec3b>(0) = {110, 150, 205};
    image.at<cv::Vec3b>(1) = {130, 130, 130};
    image.at<cv::Vec3b>(2) = {180, 90, 60};
    const cv::Mat skin = silhouette.of(image);
    CHECK(skin.at<unsigned char>(0) == 255);
    CHECK(cv::countNonZero(skin) == 1);
    silhouette.skin.cr_max = 140;  // that of the skin above is 158
    CHECK(cv::countNonZero(silhouette.of(image)) == 0);
    CHECK(cv::countNonZero(silhouette.of(cv::Mat(4, 4, CV_8UC1, cv::Scalar(200)))) == 0);
}
