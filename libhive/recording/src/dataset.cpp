#include <hive/error.hpp>
#include <hive/recording/dataset.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace hive::recording {
namespace {

std::string yolo_line(std::size_t category, const Detection& box, double width, double height)
{
    const double left = std::clamp(box.x, 0.0, width), right = std::clamp(box.x + box.w, 0.0, width);
    const double top = std::clamp(box.y, 0.0, height), bottom = std::clamp(box.y + box.h, 0.0, height);
    if (!(right > left && bottom > top))
        return "";
    char line[128];
    std::snprintf(line, sizeof line, "%zu %.6f %.6f %.6f %.6f\n", category, (left + right) / 2 / width,
                  (top + bottom) / 2 / height, (right - left) / width, (bottom - top) / height);
    return line;
}

bool same_capture(const DetectedImage& a, const DetectedImage& b)
{
    return a.source == b.source && a.epoch == b.epoch && a.sequence == b.sequence;
}

}  // namespace

Dataset::Added Dataset::add(const DetectedImage& image)
{
    if (image.width == 0 || image.height == 0)
        throw Error(Errc::refused, image.sender + "." + image.output + ", " + image.source + " "
                                       + std::to_string(image.sequence)
                                       + ": the header has no width and height of the image");
    const auto [place, fresh] = by_name_.try_emplace(image.name, images_.size());
    if (fresh)
        images_.push_back({image, {}});
    Image& stored = images_[place->second];
    if (!same_capture(stored.image, image))
        return Added::other_capture;
    for (const Detection& one : image.detections)
        if (one.certain())
            stored.boxes.push_back({one, category(one.category)});
    return fresh ? Added::fresh : Added::again;
}

std::size_t Dataset::category(const std::string& name)
{
    const auto found = std::ranges::find(categories_, name);
    const auto index = static_cast<std::size_t>(found - categories_.begin());
    if (found == categories_.end())
        categories_.push_back(name);
    return index;
}

Json Dataset::coco_results() const
{
    Json results = Json::array();
    for (std::size_t i = 0; i < images_.size(); ++i)
        for (const auto& [box, category] : images_[i].boxes)
            results.push_back({{"image_id", i + 1},
                               {"category_id", category + 1},
                               {"bbox", {box.x, box.y, box.w, box.h}},
                               {"score", box.score.value_or(1)}});
    return results;
}

Json Dataset::coco() const
{
    Json dataset{{"info", {{"description", "Detections by Hive"}}},
                 {"images", Json::array()},
                 {"categories", Json::array()},
                 {"annotations", coco_results()}};
    for (std::size_t i = 0; i < images_.size(); ++i) {
        const DetectedImage& image = images_[i].image;
        dataset["images"].push_back(
            {{"id", i + 1}, {"file_name", image.name}, {"width", image.width}, {"height", image.height}});
    }
    for (std::size_t i = 0; i < categories_.size(); ++i)
        dataset["categories"].push_back({{"id", i + 1}, {"name", categories_[i]}});
    std::size_t id = 0;
    for (Json& annotation : dataset["annotations"]) {
        annotation["id"] = ++id;
        annotation["area"] = annotation["bbox"][2].get<double>() * annotation["bbox"][3].get<double>();
        annotation["iscrowd"] = 0;
    }
    return dataset;
}

std::map<std::string, std::string> Dataset::yolo() const
{
    std::map<std::string, std::string> files;
    for (const auto& [image, boxes] : images_) {
        const auto [file, fresh] = files.try_emplace(std::filesystem::path(image.name).stem().string() + ".txt");
        if (!fresh)
            throw Error(Errc::refused, "two images would have the label file " + file->first
                                           + ": their names differ only in the extension");
        for (const auto& [box, category] : boxes)
            file->second +=
                yolo_line(category, box, static_cast<double>(image.width), static_cast<double>(image.height));
    }
    return files;
}

}  // namespace hive::recording
