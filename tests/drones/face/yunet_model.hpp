// A model in YuNet's form, made up: it sees the same faces in every image of 32x32 px.
#pragma once

#include "../detect/onnx_writer.hpp"

#include <vector>

namespace onnx {

/// Says that there is a face of 16 px in the cell in column 2, row 1, and a weaker one in the next cell.
inline Model yunet_model()
{
    // An image of 32x32 px has 58 places: 16 cells of 8 px with faces of 10, 16 and 24 px, 4 of 16 px with two, 1 of
    // 32 px with two.
    constexpr int places = 58;
    Model result{.width = 32, .height = 32, .shape = {1, 1}, .constants = {0}, .wires = {}};
    std::vector<float> conf(2 * places, 0.0F), iou(places, 0.0F);
    const std::size_t first = (1 * 4 + 2) * 3 + 1, next = first + 3;
    conf[2 * first + 1] = 1;
    iou[first] = 0.81F;
    conf[2 * next + 1] = 1;
    iou[next] = 0.25F;
    result.more = {{"loc", {1, places, 14}, std::vector<float>(14 * places, 0.0F)},
                   {"conf", {1, places, 2}, conf},
                   {"iou", {1, places, 1}, iou}};
    return result;
}

}  // namespace onnx
