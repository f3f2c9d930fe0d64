#include "result_format.hpp"

#include "event_row.hpp"
#include "output.hpp"

#include <hive/error.hpp>

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

bool in_a_folder(const std::string& form) { return form == "coco" || form == "yolo"; }

}  // namespace

ResultFormat::ResultFormat(std::string form, const std::string& folder) : form_(std::move(form)), folder_(folder)
{
    if (in_a_folder(form_) && folder.empty())
        throw hive::Error(hive::Errc::invalid_argument, "--as " + form_ + " writes files: name a folder, -o FOLDER");
    if (!in_a_folder(form_) && !folder.empty())
        throw hive::Error(hive::Errc::invalid_argument,
                          "-o goes with --as coco and --as yolo; the other forms are printed");
    std::error_code missing;
    if (!folder.empty() && fs::exists(folder_, missing) && !fs::is_empty(folder_, missing))
        throw hive::Error(hive::Errc::refused, folder + " exists and is not an empty folder", "name another folder");
}

std::string ResultFormat::text(const hive::Event& event)
{
    if (form_ == "json")
        return event_row(event).json() + "\n";
    const auto image = hive::recording::detections_in(event);
    if (form_ == "csv")
        return (std::exchange(headed_, true) ? "" : hive::recording::csv_heading()) + hive::recording::csv_rows(image);
    repeated_ += dataset_.add(image) == Dataset::Added::other_capture;
    return "";
}

void ResultFormat::finish() const
{
    if (!in_a_folder(form_))
        return;
    make_folder(folder_);
    form_ == "coco" ? write_coco() : write_yolo();
    if (repeated_ > 0)
        complain("results", std::to_string(repeated_)
                                + " results left out: another capture has the same image name; a dataset has each "
                                  "image once");
    write_out(printable(folder_.string()) + ": " + std::to_string(dataset_.size()) + " images, "
              + std::to_string(dataset_.coco_results().size()) + " boxes, "
              + std::to_string(dataset_.categories().size()) + " categories\n");
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
