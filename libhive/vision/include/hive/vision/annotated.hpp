// Emitting a picture with something drawn on it.
#pragma once

#include <hive/vision/image.hpp>
#include <hive/vision/loans.hpp>

#include <utility>

namespace hive::vision {

/// Emits a copy of `picture` (1 or 3 channels) in colour after `draw(cv::Mat&)` has drawn on it, in the memory that
/// receivers map. Made only when somebody wants it.
/// @param loans  of that output
/// @param header  what the event tells beside the form of the picture
template <class Output, class Draw>
void emit_annotated(const Output& output, LoanAllocator& loans, Json header, const cv::Mat& picture, Draw draw)
{
    const auto form = plain_form(picture.size(), 3);
    header.update(form.header);
    output.emit(
        std::move(header),
        [&] {
            cv::Mat canvas = loans.colour_copy(picture);
            draw(canvas);
            return form.body(canvas);
        },
        form.type);
}

}  // namespace hive::vision
