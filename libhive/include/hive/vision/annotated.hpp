// Emits an image with something drawn on it.
#pragma once

#include <hive/vision/image.hpp>
#include <hive/vision/loans.hpp>

#include <utility>

namespace hive::vision {

/// Emits a colour copy of `image` (1 or 3 channels) after `draw(cv::Mat&)` has drawn on it, in the memory that
/// receivers map. The copy is made only if a receiver requests it.
/// @param loans  of this output
/// @param header  the event's header, without the fields of the image format
template <class Output, class Draw>
void emit_annotated(const Output& output, LoanAllocator& loans, Json header, const cv::Mat& image, Draw draw)
{
    const auto form = plain_form(image.size(), 3);
    header.update(form.header);
    output.emit(
        std::move(header),
        [&] {
            cv::Mat canvas = loans.colour_copy(image);
            draw(canvas);
            return form.body(canvas);
        },
        form.type);
}

}  // namespace hive::vision
