// Loads the model and explains failures, converts pictures to inputs and outputs to objects.
#include "network.hpp"

#include "onnx_file.hpp"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace detect {
namespace {

constexpr std::size_t longest_name = 64;
constexpr int usual_side = 640;               ///< px; of YOLO
const cv::Scalar margin_grey(114, 114, 114);  // what YOLO models were trained with

void require_file(const std::string& path, const std::string& what)
{
    if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("no " + what + " at " + path);
}

cv::dnn::Net read_net(const std::string& path)
{
    require_file(path, "model");
    try {
        cv::dnn::Net net = cv::dnn::readNetFromONNX(path);
        if (!net.empty())
            return net;
    } catch (const cv::Exception&) {  // names lines of OpenCV; the sentence below says what a user can know
    }
    throw std::runtime_error(path + " is not an ONNX model that OpenCV's DNN can read");
}

std::vector<int> shape_of(const cv::Mat& output) { return {output.size.p, output.size.p + output.dims}; }

}  // namespace

std::vector<std::string> class_names(const std::string& path)
{
    std::vector<std::string> names;
    if (path.empty())
        return names;
    require_file(path, "file of class names");
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.ends_with('\r'))
            line.pop_back();
        if (line.size() > longest_name)
            throw std::runtime_error(path + " is not a file of class names: a line has more than 64 bytes");
        names.push_back(line);
    }
    while (!names.empty() && names.back().empty())
        names.pop_back();
    if (names.empty())
        throw std::runtime_error(path + " has no class names");
    return names;
}

cv::Scalar mean_from(const std::string& text)
{
    std::vector<double> numbers;
    std::istringstream list(text);
    for (std::string item; std::getline(list, item, ',');) {
        std::istringstream one(item);
        if (!(one >> numbers.emplace_back()) || !(one >> std::ws).eof())
            numbers.resize(4);  // never right
    }
    if (numbers.size() == 1)
        return cv::Scalar::all(numbers[0]);
    if (numbers.size() != 3)
        throw std::runtime_error("mean is one number, or three as in 104,177,123, but not " + text);
    return {numbers[0], numbers[1], numbers[2]};
}

Network::Network(const NetworkSettings& settings)
    : settings_(settings), names_(class_names(settings.classes)), net_(read_net(settings.model))
{
    read_card();
    choose_output();
}

/// What the file tells counts where nothing else was told.
void Network::read_card()
{
    const ModelCard card = model_card(settings_.model);
    const auto side = [](int told, int in_file) { return told > 0 ? told : in_file > 0 ? in_file : usual_side; };
    settings_.input = {side(settings_.input.width, card.input.width), side(settings_.input.height, card.input.height)};
    const auto short_enough = [](const std::string& name) { return name.size() <= longest_name; };
    if (names_.empty() && std::ranges::all_of(card.names, short_enough))
        names_ = card.names;
}

void Network::choose_output()
{
    std::vector<std::vector<int>> shapes;
    try {
        for (const cv::Mat& output : run(cv::Mat(settings_.input, CV_8UC3, margin_grey)))
            shapes.push_back(output.type() == CV_32F ? shape_of(output) : std::vector<int>());
    } catch (const cv::Exception& error) {
        throw std::runtime_error(settings_.model + " does not run with an input of "
                                 + std::to_string(settings_.input.width) + "x" + std::to_string(settings_.input.height)
                                 + " (input_width, input_height): " + error.err);
    }
    if (const auto place = layout_of(shapes, names_.size(), settings_.layout)) {
        place_ = *place;
        return;
    }
    std::string list;
    for (const auto& shape : shapes)
        list += (list.empty() ? "" : ", ") + shape_text(shape);
    const std::string classes =
        names_.empty() ? "" : " for the " + std::to_string(names_.size()) + " classes that are named";
    throw std::runtime_error(settings_.model + " gives " + list + ", which is no output of "
                             + (settings_.layout.empty() ? "a known detector" : "the layout " + settings_.layout)
                             + classes
                             + ": 1xNx(5+classes), 1x(4+classes)xN, 1xNx6, Nx7, 1x1xNx7, or 1xNx4 and 1xNxclasses");
}

std::vector<cv::Mat> Network::run(const cv::Mat& input)
{
    cv::Mat blob = cv::dnn::blobFromImage(input, settings_.scale, settings_.input, settings_.mean, settings_.swap);
    std::vector<cv::Mat> outputs;
    net_.setInput(blob);
    net_.forward(outputs, net_.getUnconnectedOutLayersNames());
    return outputs;
}

Network::Fit Network::fit(cv::Size picture) const
{
    const cv::Point2d whole(static_cast<double>(settings_.input.width) / picture.width,
                            static_cast<double>(settings_.input.height) / picture.height);
    if (settings_.fit == "stretch")
        return {whole, {0, 0}};
    const double scale = std::min(whole.x, whole.y);
    return {
        {scale, scale},
        {(settings_.input.width - scale * picture.width) / 2, (settings_.input.height - scale * picture.height) / 2}};
}

cv::Mat Network::input_from(const cv::Mat& picture, const Fit& fit) const
{
    cv::Mat colour = picture;
    if (picture.channels() == 1)
        cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
    cv::Rect place(cvRound(fit.offset.x), cvRound(fit.offset.y), cvRound(fit.scale.x * picture.cols),
                   cvRound(fit.scale.y * picture.rows));
    place = (place + cv::Size(place.width == 0, place.height == 0)) & cv::Rect({}, settings_.input);
    cv::Mat input(settings_.input, CV_8UC3, margin_grey);
    cv::resize(colour, input(place), place.size());
    return input;
}

std::string Network::name(int class_index) const
{
    const auto index = static_cast<std::size_t>(class_index);
    return index < names_.size() ? names_[index] : std::to_string(class_index);
}

std::vector<Object> Network::find(const cv::Mat& picture)
{
    const Fit fitted = fit(picture.size());
    const auto outputs = run(input_from(picture, fitted));
    std::map<int, std::pair<std::vector<cv::Rect2d>, std::vector<float>>> by_class;
    for (const Candidate& candidate : candidates(outputs, place_, settings_.input, min_score)) {
        const cv::Point2d corner((candidate.box.x - fitted.offset.x) / fitted.scale.x,
                                 (candidate.box.y - fitted.offset.y) / fitted.scale.y);
        const cv::Size2d size(candidate.box.width / fitted.scale.x, candidate.box.height / fitted.scale.y);
        auto& [boxes, scores] = by_class[candidate.class_index];
        boxes.emplace_back(corner, size);
        scores.push_back(static_cast<float>(candidate.score));
    }
    std::vector<Object> objects;
    for (const auto& [class_index, found] : by_class) {
        const auto& [boxes, scores] = found;
        std::vector<int> kept;
        cv::dnn::NMSBoxes(boxes, scores, 0, static_cast<float>(overlap), kept);
        for (const int i : kept)
            if (const cv::Rect box = cv::Rect(boxes[i]) & cv::Rect({}, picture.size()); !box.empty())
                objects.push_back({box, name(class_index), scores[i]});
    }
    sort(objects);
    objects.resize(std::min(objects.size(), most_objects));
    return objects;
}

}  // namespace detect
