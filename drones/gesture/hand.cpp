// Names poses and draws hands.
#include "hand.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace gesture {

std::string_view pose(const Hand& hand)
{
    constexpr std::array<std::string_view, 6> words{"fist", "one", "two", "three", "four", "open"};
    return words[std::min(hand.tips.size(), words.size() - 1)];
}

void draw(cv::Mat& image, const std::vector<Hand>& hands)
{
    const cv::Scalar green(60, 220, 60), orange(30, 140, 250);
    for (const Hand& hand : hands) {
        cv::rectangle(image, hand.box, green, 2, cv::LINE_AA);
        cv::circle(image, hand.palm, static_cast<int>(std::lround(hand.radius)), orange, 2, cv::LINE_AA);
        for (const cv::Point& tip : hand.tips) {
            cv::line(image, hand.palm, tip, orange, 2, cv::LINE_AA);
            cv::circle(image, tip, 5, green, cv::FILLED, cv::LINE_AA);
        }
        cv::putText(image, std::string(pose(hand)), hand.box.tl() + cv::Point(6, 22), cv::FONT_HERSHEY_SIMPLEX, 0.7,
                    green, 2, cv::LINE_AA);
    }
}

}  // namespace gesture
