// Results in the form that --as names: lines to print, and files in a folder.
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
    /// @param folder  for coco and yolo: does not exist yet, or is empty
    /// @param fields  for csv: of the header, instead of boxes; "": boxes
    /// @throws Error  invalid_argument: they do not fit; refused: a folder with something in it
    ResultFormat(std::string form, const std::string& folder, const std::string& fields);

    /// What to print for this event, perhaps nothing. Throws Errc::refused for an event that the form cannot hold.
    std::string text(const hive::Event& event);
    /// Is there anything for the files?
    [[nodiscard]] bool has_images() const { return dataset_.size() > 0; }
    /// Writes the files, and says on stderr what a table lacks. Throws Errc::io.
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
