// Draws marks onto images: the algorithm of the annotate drone, plain OpenCV.
#pragma once

#include "marks.hpp"

#include <opencv2/core/mat.hpp>

namespace annotate {

class Drawing {
public:
    enum class Uncertain { dashed, hidden, solid };
    int thickness = 0;                        ///< of lines, px, up to 20; 0: by the size of the image
    bool labels = true;                       ///< write the labels of the marks
    Uncertain uncertain = Uncertain::dashed;  ///< how the boxes of uncertain marks are drawn

    /// @param image  8 bit, BGR or grey; not changed
    /// @param result   becomes a BGR image of the same size; must not be `image`
    void draw(const cv::Mat& image, const Marks& marks, cv::Mat& result) const;
    /// BGR; always the same for one text, rarely the same for two; green without text.
    static cv::Scalar colour_of(const std::string& text);

private:
    [[nodiscard]] int width_for(const cv::Mat& image) const;
    void draw(cv::Mat& image, const Mark& mark) const;
    void draw(cv::Mat& image, const Shape& shape, const Mark& mark) const;
    void draw(cv::Mat& image, const Region& region) const;
};

}  // namespace annotate
