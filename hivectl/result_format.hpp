// Results in the form that --as names: lines to print, and files in a folder.
#pragma once

#include <hive/recording/dataset.hpp>

#include <filesystem>
#include <string>

namespace hivectl {

class ResultFormat {
public:
    /// @param form    "json", "csv", "coco" or "yolo"
    /// @param folder  for coco and yolo: does not exist yet, or is empty
    /// @throws Error  invalid_argument: the two do not fit; refused: a folder with something in it
    ResultFormat(std::string form, const std::string& folder);

    /// What to print for this event, perhaps nothing. Throws Errc::refused for an event that the form cannot hold.
    std::string text(const hive::Event& event);
    /// Is there anything for the files?
    [[nodiscard]] bool has_images() const { return dataset_.size() > 0; }
    /// Writes the files. Throws Errc::io.
    void finish() const;

private:
    void write_coco() const;
    void write_yolo() const;

    std::string form_;
    std::filesystem::path folder_;
    bool headed_ = false;
    std::size_t repeated_ = 0;
    hive::recording::Dataset dataset_;
};

}  // namespace hivectl
