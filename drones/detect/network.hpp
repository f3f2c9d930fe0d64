// Finds objects with a network from an ONNX file.
#pragma once

#include "engine.hpp"
#include "fit.hpp"
#include "model_output.hpp"
#include "object.hpp"

#include <memory>
#include <string>
#include <vector>

namespace detect {

/// The settings of a model, from the model's page.
struct NetworkSettings {
    std::string model;         ///< path of the .onnx file
    std::string classes;       ///< path of a text file, one name a line in the order of the model; empty: those in the
                               ///< model's file, or else numbers
    cv::Size input;            ///< px; a side of 0: from the file, or else 640
    std::string layout;        ///< the name of one; empty: by the outputs
    std::string fit = "auto";  ///< a name of a Fit::Kind; "auto": crop for a classifier, else letterbox
    double scale = 1.0 / 255;  ///< the input is (pixel - mean) * scale
    cv::Scalar mean;           ///< for each channel, in the order of the model
    bool swap = true;          ///< the model's input is RGB; images are BGR
    std::string engine = "auto";  ///< "opencv", "onnxruntime", or "auto": OpenCV, else ONNX Runtime if it is there
    std::string onnxruntime;      ///< path of its library; empty: where the dynamic linker finds it

    bool operator==(const NetworkSettings&) const = default;
};

class Network {
public:
    double min_score = 0.5;  ///< 0 to 1
    double overlap =
        0.45;  ///< of two boxes of one class that overlap more (intersection over union), the better one is kept

    /// Reads the files and runs the model once, to check it and to get the form of its output.
    /// @throws std::runtime_error  with the reason as a sentence
    explicit Network(const NetworkSettings& settings);

    /// @param image  8 bit, BGR or grey; not changed
    /// @throws std::runtime_error  for a score above 1
    [[nodiscard]] std::vector<Object> find(const cv::Mat& image);
    [[nodiscard]] std::string_view layout() const { return place_.layout->name; }
    [[nodiscard]] cv::Size input() const { return settings_.input; }
    [[nodiscard]] std::size_t classes() const { return names_.size(); }  ///< that have a name

private:
    void read_card();
    void choose_engine();
    /// Runs the model once with that engine.
    void use(std::unique_ptr<Engine> engine);
    [[nodiscard]] Place place_in(const std::vector<cv::Mat>& outputs) const;
    [[nodiscard]] Fit::Kind kind_of_fit() const;
    [[nodiscard]] std::vector<cv::Mat> run(const cv::Mat& input) const;
    [[nodiscard]] std::vector<Candidate> kept(std::vector<Candidate> found) const;
    [[nodiscard]] Object object_from(const Candidate& candidate, const std::vector<cv::Mat>& outputs,
                                     const Fit& fit) const;
    [[nodiscard]] std::string name(int class_index) const;

    NetworkSettings settings_;
    std::vector<std::string> names_;
    Knowledge known_;
    std::unique_ptr<Engine> engine_;
    Place place_;  ///< of the objects among the model's outputs
};

/// The lines of the file; none without a path.
/// @throws std::runtime_error  if the file cannot be read or is not a list of class names
std::vector<std::string> class_names(const std::string& path);
/// "104,177,123" or one number for all channels. @throws std::runtime_error
cv::Scalar mean_from(const std::string& text);

}  // namespace detect
