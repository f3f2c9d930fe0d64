// Reads the metadata of an ONNX file without loading the network: the size of its input, and the classes and task of
// Ultralytics' exports.
#pragma once

#include <opencv2/core/types.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace detect {

struct ModelCard {
    cv::Size input;                      ///< px; 0: not fixed, or unknown
    std::vector<std::string> names;      ///< of the classes, empty: unknown
    std::string task;                    ///< detect, segment, pose, obb or classify; empty: unknown
    int keypoints = 0, numbers = 3;      ///< of an object, and of a keypoint; 0: unknown
    std::vector<std::string> operators;  ///< of its graph, each once, in the order of their first use

    bool operator==(const ModelCard&) const = default;
};

/// Reads a few fields and skips the weights. A damaged or invalid file gives empty fields; this function does not check
/// that it is a model.
ModelCard model_card(const std::string& path);

/// {0: 'person', 1: "cat's bed"} in the order of the numbers, which have to be 0, 1, 2 and so on; empty if it is
/// anything else.
std::vector<std::string> names_from(const std::string& text);

/// [17, 3]: 2 or 3 numbers of each keypoint; nothing if it is anything else.
std::optional<std::pair<int, int>> keypoints_from(const std::string& text);

}  // namespace detect
