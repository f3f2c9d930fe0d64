// Runs models with OpenCV's DNN, and names the operator that it lacks.
#include "engine.hpp"

#include "onnx_file.hpp"

#include <opencv2/core/utility.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/dnn/layer.hpp>

#include <algorithm>
#include <array>
#include <regex>
#include <string_view>

namespace detect {
namespace {

/// Operators of today's exports that OpenCV 4.6 lacks (modules/dnn/src/onnx/onnx_importer.cpp, the dispatch map). Its
/// own message names the first node after one of them.
constexpr std::array<std::string_view, 30> rare{"TopK",
                                                "NonMaxSuppression",
                                                "GridSample",
                                                "LayerNormalization",
                                                "GroupNormalization",
                                                "Einsum",
                                                "GatherND",
                                                "GatherElements",
                                                "Mod",
                                                "ScatterND",
                                                "ScatterElements",
                                                "Where",
                                                "Tile",
                                                "Gelu",
                                                "Hardmax",
                                                "NonZero",
                                                "Range",
                                                "RoiAlign",
                                                "If",
                                                "Loop",
                                                "OneHot",
                                                "Trilu",
                                                "And",
                                                "Or",
                                                "Not",
                                                "Compress",
                                                "Unique",
                                                "EyeLike",
                                                "GlobalLpPool",
                                                "RandomNormalLike"};

/// A later OpenCV may have it, as a layer of that name.
bool is_layer(const std::string& name)
{
    try {
        cv::dnn::LayerParams parameters;
        return !cv::dnn::LayerFactory::createLayerInstance(name, parameters).empty();
    } catch (const cv::Exception&) {
        return true;  // it requires parameters
    }
}

std::string lacking_in(const std::string& model)
{
    std::string list;
    for (const std::string& name : model_card(model).operators)
        if (std::ranges::find(rare, name) != rare.end() && !is_layer(name))
            list += (list.empty() ? "" : ", ") + name;
    return list;
}

class OpenCvEngine : public Engine {
public:
    explicit OpenCvEngine(const std::string& model) : model_(model)
    {
        try {
            net_ = cv::dnn::readNetFromONNX(model);
        } catch (const cv::Exception& error) {
            refuse(error.what());
        }
        if (net_.empty())
            refuse("");
    }

    std::vector<cv::Mat> run(const cv::Mat& input) override
    {
        std::vector<cv::Mat> outputs;
        try {
            net_.setInput(input);
            net_.forward(outputs, net_.getUnconnectedOutLayersNames());
        } catch (const cv::Exception& error) {
            throw EngineError("does not run with an input of " + std::to_string(input.size[3]) + "x"
                              + std::to_string(input.size[2]) + " (input_width, input_height): " + error.err);
        }
        return outputs;
    }

private:
    /// @param reason  of OpenCV
    [[noreturn]] void refuse(const std::string& reason) const
    {
        const std::string lacking = lacking_in(model_);
        if (!lacking.empty())
            throw EngineError("needs " + lacking + ", which OpenCV " + cv::getVersionString() + " cannot run");
        std::smatch node;
        const bool named = std::regex_search(reason, node, std::regex(R"(Node \[(\w+))"));
        throw EngineError("is not an ONNX model that OpenCV's DNN can read"
                          + (named ? ": it fails at the operator " + node[1].str() : ""));
    }

    std::string model_;
    cv::dnn::Net net_;
};

}  // namespace

std::unique_ptr<Engine> opencv_engine(const std::string& model) { return std::make_unique<OpenCvEngine>(model); }

}  // namespace detect
