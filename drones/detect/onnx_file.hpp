// What an ONNX file says of the model in it, read without the network: the size of its input, and the names of its
// classes.
#pragma once

#include <opencv2/core/types.hpp>

#include <string>
#include <vector>

namespace detect {

struct ModelCard {
    cv::Size input;                  ///< px; 0: not fixed, or not told
    std::vector<std::string> names;  ///< of the classes, as Ultralytics' exports tell them; empty: not told

    bool operator==(const ModelCard&) const = default;
};

/// Reads a few fields and leaps over the weights. A file that is damaged, or none, tells nothing; whether it is a model
/// is not for this function to say.
ModelCard model_card(const std::string& path);

/// {0: 'person', 1: "cat's bed"} in the order of the numbers, which have to be 0, 1, 2 and so on; empty if it is
/// anything else.
std::vector<std::string> names_from(const std::string& text);

}  // namespace detect
