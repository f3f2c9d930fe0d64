#include "run/result_format.hpp"

#include "run/event_row.hpp"
#include "words/format.hpp"
#include "words/output.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <fstream>
#include <utility>

namespace hivectl {
namespace {

namespace fs = std::filesystem;
using hive::recording::Dataset;

void write_file(const fs::path& path, const std::string& text)
{
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush())
        throw hive::Error(hive::Errc::io, "cannot write " + path.string());
}

void make_folder(const fs::path& folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error)
        throw hive::Error(hive::Errc::io, "cannot create " + folder.string() + ": " + error.message());
}

/// The next command: the header shows the available columns.
std::string field_advice(const hive::Json& header)
{
    constexpr std::size_t max_fields = 6;
    std::string names;
    const auto fields = hive::recording::single_fields(header);
    for (std::size_t i = 0; i < std::min(fields.size(), max_fields); ++i)
        names += (i == 0 ? "" : ",") + fields[i];
    return names.empty() ? "see what is in it: --as json"
                         : "name fields of the header: --fields " + names + (fields.size() > max_fields ? ",..." : "");
}

std::string counted(std::size_t count, const char* one, const char* several)
{
    return std::to_string(count) + " " + (count == 1 ? one : several);
}

bool in_a_folder(const std::string& form) { return form == "coco" || form == "yolo"; }

}  // namespace

ResultFormat::ResultFormat(std::string form, const std::string& folder, const std::string& fields)
    : form_(std::move(form)), folder_(folder)
{
    if (!fields.empty() && form_ != "csv")
        throw hive::Error(hive::Errc::invalid_argument, "--fields needs --as csv", "json has all fields");
    if (!fields.empty())
        table_.emplace(fields);
    if (in_a_folder(form_) && folder.empty())
        throw hive::Error(hive::Errc::invalid_argument, "--as " + form_ + " writes files: name a folder, -o FOLDER");
    if (!in_a_folder(form_) && !folder.empty())
        throw hive::Error(hive::Errc::invalid_argument, "-o needs --as coco or --as yolo; other forms are printed");
    std::error_code missing;
    if (!folder.empty() && fs::exists(folder_, missing) && !fs::is_empty(folder_, missing))
        throw hive::Error(hive::Errc::refused, folder + " exists and is not an empty folder", "name another folder");
}

std::string ResultFormat::text(const hive::Event& event)
{
    if (form_ == "json")
        return event_row(event).json() + "\n";
    if (form_ == "csv")
        return csv_lines(event);
    repeated_ += dataset_.add(hive::recording::detections_in(event)) == Dataset::Added::other_capture;
    return "";
}

std::string ResultFormat::csv_lines(const hive::Event& event)
{
    ++events_;
    last_header_ = event.header;
    const bool headed = std::exchange(headed_, true);
    if (table_)
        return (headed ? "" : table_->heading()) + table_->row(event);
    try {
        const auto image = hive::recording::detections_in(event);
        boxes_ += image.detections.size();
        return (headed ? "" : hive::recording::csv_heading()) + hive::recording::csv_rows(image);
    } catch (const hive::Error& error) {
        throw hive::Error(error.code(), error.what(), field_advice(event.header));
    }
}

void ResultFormat::say_what_is_missing() const
{
    if (events_ == 0)
        return;
    if (!table_ && boxes_ == 0)
        complain("results", "no boxes in " + count_text(static_cast<std::int64_t>(events_), "result") + "; "
                                + printable(field_advice(last_header_)));
    for (const auto& field : table_ ? table_->missing() : std::vector<std::string>{})
        complain("results",
                 "no result has the field " + printable(field) + "; " + printable(field_advice(last_header_)));
}

void ResultFormat::finish() const
{
    if (!in_a_folder(form_))
        return say_what_is_missing();
    make_folder(folder_);
    form_ == "coco" ? write_coco() : write_yolo();
    if (repeated_ > 0)
        complain("results", std::to_string(repeated_)
                                + " results left out: another capture has the same image name; a dataset has each "
                                  "image once");
    write_out(printable(folder_.string()) + ": " + counted(dataset_.size(), "image", "images") + ", "
              + counted(dataset_.coco_results().size(), "box", "boxes") + ", "
              + counted(dataset_.categories().size(), "category", "categories") + "\n");
}

void ResultFormat::write_coco() const
{
    write_file(folder_ / "dataset.json", json_text(dataset_.coco()) + "\n");
    write_file(folder_ / "results.json", json_text(dataset_.coco_results()) + "\n");
}

void ResultFormat::write_yolo() const
{
    make_folder(folder_ / "labels");
    for (const auto& [name, text] : dataset_.yolo())
        write_file(folder_ / "labels" / name, text);
    std::string classes;
    for (const auto& name : dataset_.categories())
        classes += printable(name) + "\n";
    write_file(folder_ / "classes.txt", classes);
}

}  // namespace hivectl
