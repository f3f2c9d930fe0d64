// Chooses the engine and explains refusals, converts outputs to objects.
#include "network.hpp"

#include "masks.hpp"
#include "onnx_file.hpp"

#include <opencv2/dnn.hpp>
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
constexpr int default_side = 640;  ///< px; of YOLO
constexpr double degrees = 180 / CV_PI;

void require_file(const std::string& path, const std::string& what)
{
    if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("no " + what + " at " + path);
}

cv::RotatedRect turned_box(const Candidate& candidate)
{
    const cv::Point2d middle = (candidate.box.tl() + candidate.box.br()) / 2;
    return {middle, candidate.box.size(), static_cast<float>(candidate.angle * degrees)};
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

Network::Network(const NetworkSettings& settings) : settings_(settings), names_(class_names(settings.classes))
{
    require_file(settings.model, "model");
    read_card();
    choose_engine();
}

/// Values of the file are used unless they are set.
void Network::read_card()
{
    const ModelCard card = model_card(settings_.model);
    const auto side = [](int wanted, int in_file) {
        return wanted > 0 ? wanted : in_file > 0 ? in_file : default_side;
    };
    settings_.input = {side(settings_.input.width, card.input.width), side(settings_.input.height, card.input.height)};
    const auto short_enough = [](const std::string& name) { return name.size() <= longest_name; };
    if (names_.empty() && std::ranges::all_of(card.names, short_enough))
        names_ = card.names;
    known_ = {names_.size(), settings_.input, card.task, card.keypoints, card.numbers};
}

void Network::choose_engine()
try {
    if (settings_.engine == "onnxruntime")
        return use(onnxruntime_engine(settings_.model, settings_.onnxruntime));
    std::string reason;
    try {
        return use(opencv_engine(settings_.model));
    } catch (const EngineError& error) {
        if (settings_.engine == "opencv")
            throw;
        reason = error.what();
    }
    try {
        use(onnxruntime_engine(settings_.model, settings_.onnxruntime));
    } catch (const EngineError& error) {
        throw EngineError(reason + ", and " + error.what());
    }
} catch (const EngineError& error) {
    throw std::runtime_error(settings_.model + " " + error.what());
}

void Network::use(std::unique_ptr<Engine> engine)
{
    engine_ = std::move(engine);
    place_ = place_in(run(cv::Mat(settings_.input, CV_8UC3, cv::Scalar::all(114))));
}

Place Network::place_in(const std::vector<cv::Mat>& outputs) const
{
    std::vector<std::vector<int>> shapes;
    std::string list, reason, known;
    for (const cv::Mat& output : outputs) {
        shapes.push_back(output.type() == CV_32F ? shape_of(output) : std::vector<int>());
        list += (list.empty() ? "" : ", ") + shape_text(shapes.back());
    }
    for (const Place& place : places_in(shapes, known_, settings_.layout)) {
        const auto wrong = objection(outputs, place);
        if (!wrong)
            return place;
        reason += "; " + *wrong;
    }
    if (reason.empty())
        for (const Layout& layout : layouts())
            known += (known.empty() ? ": " : ", ") + std::string(layout.name) + " " + std::string(layout.outputs);
    const std::string classes =
        names_.empty() ? "" : " for the " + std::to_string(names_.size()) + " classes that are named";
    throw std::runtime_error(settings_.model + " gives " + list + ", which is no output of "
                             + (settings_.layout.empty() ? "a known detector" : "the layout " + settings_.layout)
                             + classes + reason + known);
}

std::vector<cv::Mat> Network::run(const cv::Mat& input) const
{
    return engine_->run(
        cv::dnn::blobFromImage(input, settings_.scale, settings_.input, settings_.mean, settings_.swap));
}

Fit::Kind Network::kind_of_fit() const
{
    if (settings_.fit == "stretch")
        return Fit::Kind::stretch;
    const bool crop =
        settings_.fit == "crop" || (settings_.fit == "auto" && place_.layout->table == Layout::Table::single);
    return crop ? Fit::Kind::crop : Fit::Kind::letterbox;
}

std::string Network::name(int class_index) const
{
    const auto index = static_cast<std::size_t>(class_index);
    return index < names_.size() ? names_[index] : std::to_string(class_index);
}

/// Keeps the best of overlapping boxes of one class.
std::vector<Candidate> Network::kept(std::vector<Candidate> found) const
{
    std::map<int, std::vector<std::size_t>> by_class;
    for (std::size_t i = 0; i < found.size(); ++i)
        by_class[found[i].class_index].push_back(i);
    std::vector<Candidate> best;
    for (const auto& [class_index, places] : by_class) {
        std::vector<cv::Rect2d> boxes;
        std::vector<cv::RotatedRect> turned;
        std::vector<float> scores;
        for (const std::size_t i : places) {
            boxes.push_back(found[i].box);
            turned.push_back(turned_box(found[i]));
            scores.push_back(static_cast<float>(found[i].score));
        }
        std::vector<int> chosen;
        const auto most = static_cast<float>(overlap);
        if (place_.layout->extra == Layout::Extra::angle)
            cv::dnn::NMSBoxes(turned, scores, 0, most, chosen);
        else
            cv::dnn::NMSBoxes(boxes, scores, 0, most, chosen);
        for (const int i : chosen)
            best.push_back(std::move(found[places[static_cast<std::size_t>(i)]]));
    }
    return best;
}

Object Network::object_from(const Candidate& candidate, const std::vector<cv::Mat>& outputs, const Fit& fit) const
{
    Object object{cv::Rect(fit.in_image(candidate.box)), name(candidate.class_index), candidate.score};
    const auto place = [&](double x, double y) { return cv::Point(fit.in_image(cv::Point2d(x, y))); };
    const auto& extra = candidate.extra;
    switch (place_.layout->extra) {
    case Layout::Extra::none: break;
    case Layout::Extra::mask:
        for (const cv::Point& point : mask_outline(outputs[place_.prototypes], extra, candidate.box, settings_.input))
            object.mask.push_back(place(point.x, point.y));
        break;
    case Layout::Extra::keypoints:
        for (auto number = extra.begin(); number != extra.end(); number += place_.numbers)
            object.keypoints.push_back({place(number[0], number[1]), place_.numbers > 2 ? number[2] : 1.0});
        break;
    case Layout::Extra::angle:
        cv::Point2f corners[4];
        turned_box(candidate).points(corners);
        for (const cv::Point2f& corner : corners)
            object.corners.push_back(place(corner.x, corner.y));
        object.box = cv::boundingRect(object.corners);
        break;
    }
    return object;
}

std::vector<Object> Network::find(const cv::Mat& image)
{
    const Fit fit(image.size(), settings_.input, kind_of_fit());
    const auto outputs = run(fit.input_from(image));
    std::vector<Object> objects;
    for (const Candidate& candidate : kept(candidates(outputs, place_, settings_.input, min_score))) {
        Object object = object_from(candidate, outputs, fit);
        object.box &= cv::Rect({}, image.size());
        if (!object.box.empty())
            objects.push_back(std::move(object));
    }
    sort(objects);
    objects.resize(std::min(objects.size(), max_objects));
    return objects;
}

}  // namespace detect
