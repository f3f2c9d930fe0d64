// Writes each image whole, so that no reader sees a part of it; and chooses between folder and video.
#include "image_folder.hpp"

#include "regular_file.hpp"
#include "video_file.hpp"

#include <hive/platform/whole_file.hpp>
#include <hive/vision/image.hpp>

#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>

namespace writing {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path)
{
    throw std::system_error(errno, std::generic_category(), path.string());
}

void write_file(const fs::path& path, std::span<const unsigned char> bytes)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const auto problem = hive::platform::write_whole(path, text, {.mode = 0666}))
        throw std::system_error(problem, path.string());
}

std::string numbered(std::int64_t number, const std::string& extension)
{
    std::array<char, 32> name{};
    std::snprintf(name.data(), name.size(), "%08lld", static_cast<long long>(number));
    return name.data() + extension;
}

bool is_numbered(const fs::path& name)
{
    const auto stem = name.stem().string(), extension = name.extension().string();
    return stem.size() == 8 && stem.find_first_not_of("0123456789") == std::string::npos
           && (extension == ".jpg" || extension == ".png");
}

/// Removes earlier images, which would mix with the new ones. Other files stay.
void remove_numbered(const fs::path& folder)
{
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(folder))
        if (is_numbered(entry.path().filename()) && !fs::is_directory(entry.symlink_status()))
            old.push_back(entry.path());
    for (const auto& path : old)
        fs::remove(path);
}

}  // namespace

void ImageFolder::begin()
{
    fs::create_directories(settings_.path);
    if (settings_.overwrite)
        remove_numbered(settings_.path);
    const fs::path table = fs::path(settings_.path) / "times.csv";
    require_regular_or_missing(table);
    times_.open(table, std::ios::trunc);
    times_ << "file,seq,time_us\n";
    if (!times_.flush())
        refuse(table);
}

std::string ImageFolder::extension_for(const Image& image) const
{
    if (!image.encoded.empty())
        return image.extension;
    return image.pixels.depth() == CV_16U || settings_.quality == 100 ? ".png" : ".jpg";
}

void ImageFolder::add(const Image& image, std::chrono::microseconds time)
{
    if (count_ == 0)
        begin();
    const auto extension = extension_for(image);
    const auto name = numbered(++count_, extension);
    const fs::path path = fs::path(settings_.path) / name;
    if (!image.encoded.empty()) {
        write_file(path, image.encoded);
    } else {
        const hive::Body body = extension == ".png" ? hive::vision::encode_png(image.pixels)
                                                    : hive::vision::encode_jpeg(image.pixels, settings_.quality);
        write_file(path, {body.data(), body.size()});
    }
    times_ << name << ',' << image.sequence << ',' << time.count() << '\n';
    if (!times_.flush())
        refuse(fs::path(settings_.path) / "times.csv");
}

void ImageFolder::close() { times_.close(); }

std::unique_ptr<Sink> open_sink(const Settings& settings)
{
    const fs::path path(settings.path);
    const bool folder = !path.has_filename() || fs::is_directory(path);
    if (!folder && !VideoFile::knows(settings.path))
        throw std::runtime_error(settings.path
                                 + ": unknown extension; use .mp4, .mov, .mkv or .avi, or NAME/ for an image folder");
    if (folder && fs::exists(path) && !fs::is_empty(path) && !settings.overwrite)
        throw std::runtime_error(settings.path + " is not empty; choose another path, or set overwrite=on");
    if (!folder)
        require_regular_or_missing(path);
    if (!folder && fs::exists(path) && !settings.overwrite)
        throw std::runtime_error(settings.path + " exists already; choose another path, or set overwrite=on");
    const fs::path whole = fs::absolute(path).lexically_normal();
    const fs::path parent = (whole.has_filename() ? whole : whole.parent_path()).parent_path();
    if (!fs::is_directory(parent))
        throw std::runtime_error("no such folder: " + parent.string());
    if (folder)
        return std::make_unique<ImageFolder>(settings);
    return std::make_unique<VideoFile>(settings);
}

}  // namespace writing
