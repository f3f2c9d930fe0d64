// Runs the network of an ONNX file: one interface, two engines.
#pragma once

#include <opencv2/core/mat.hpp>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace detect {

/// An engine cannot run a model; a sentence without the model's path in front.
class EngineError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Engine {
public:
    virtual ~Engine() = default;
    /// @param input  1 x 3 x height x width floats
    /// @return the outputs as floats, each with two sides or more; valid until the next call
    /// @throws EngineError
    [[nodiscard]] virtual std::vector<cv::Mat> run(const cv::Mat& input) = 0;
};

/// OpenCV's DNN, which is always available. @throws EngineError
std::unique_ptr<Engine> opencv_engine(const std::string& model);

/// ONNX Runtime, if installed: it runs all operators of ONNX.
/// @param library  path of libonnxruntime.so; empty: where the dynamic linker finds it
/// @throws EngineError  also if the library is missing
std::unique_ptr<Engine> onnxruntime_engine(const std::string& model, const std::string& library);

}  // namespace detect
