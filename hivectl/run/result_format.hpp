// Results in the form of --as: lines to print, and files in a folder.
#pragma once

#include <hive/recording/dataset.hpp>
#include <hive/recording/field_table.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace hivectl {

class ResultFormat {
public:
    /// @param form    "json", "csv", "coco" or "yolo"
    /// @param folder  for coco and yolo: must be new or empty
    /// @param fields  for csv: fields of the header, instead of boxes; "": boxes
    /// @throws Error  invalid_argument: they contradict each other; refused: the folder is not empty
    ResultFormat(std::string form, const std::string& folder, const std::string& fields);

    /// The text to print for this event, possibly empty. Throws Errc::refused for an event that the form cannot
    /// represent.
    std::string text(const hive::Event& event);
    /// Is there content for the files?
    [[nodiscard]] bool has_images() const { return dataset_.size() > 0; }
    /// Writes the files, and prints missing columns on stderr. Throws Errc::io.
    void finish() const;

private:
    std::string csv_lines(const hive::Event& event);
    void say_what_is_missing() const;
    void write_coco() const;
    void write_yolo() const;

    std::string form_;
    std::filesystem::path folder_;
    bool headed_ = false;
    std::size_t repeated_ = 0, events_ = 0, boxes_ = 0;
    hive::Json last_header_;
    std::optional<hive::recording::FieldTable> table_;
    hive::recording::Dataset dataset_;
};

}  // namespace hivectl
