// Draws marks onto pictures: the algorithm of the annotate drone, plain OpenCV.
#pragma once

#include "marks.hpp"

#include <opencv2/core/mat.hpp>

namespace annotate {

class Drawing {
public:
    int thickness = 2;   ///< of lines, px, 1 to 20
    bool labels = true;  ///< write what the marks are

    /// @param picture  8 bit, BGR or grey; not changed
    /// @param result   becomes a BGR picture of the same size; another one than `picture`
    void draw(const cv::Mat& picture, const Marks& marks, cv::Mat& result) const;
    /// BGR; of a track always the same, and of two tracks hardly ever; green without id.
    static cv::Scalar colour_of(const std::string& id);

private:
    void draw(cv::Mat& picture, const Mark& mark) const;
    void draw(cv::Mat& picture, const Shape& shape, const cv::Scalar& colour) const;
    static void write(cv::Mat& picture, const Mark& mark, const cv::Scalar& colour);
};

}  // namespace annotate
