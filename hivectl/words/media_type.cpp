// The table of extensions.
#include "words/media_type.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace hivectl {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 17> endings{{
    {".jpg", "image/jpeg"},
    {".jpeg", "image/jpeg"},
    {".png", "image/png"},
    {".bmp", "image/bmp"},
    {".webp", "image/webp"},
    {".tif", "image/tiff"},
    {".tiff", "image/tiff"},
    {".gif", "image/gif"},
    {".avif", "image/avif"},
    {".ppm", "image/x-portable-pixmap"},
    {".pgm", "image/x-portable-graymap"},
    {".json", "application/json"},
    {".txt", "text/plain"},
    {".mp4", "video/mp4"},
    {".mov", "video/quicktime"},
    {".mkv", "video/x-matroska"},
    {".avi", "video/x-msvideo"},
}};

}  // namespace

std::string media_type_of(const std::filesystem::path& file)
{
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    const auto found = std::ranges::find(endings, std::string_view(ending), [](const auto& row) { return row.first; });
    return found == endings.end() ? std::string() : std::string(found->second);
}

std::string ending_of(std::string_view type)
{
    const auto found = std::ranges::find(endings, type, [](const auto& row) { return row.second; });
    return found == endings.end() ? std::string() : std::string(found->first);
}

bool ending_fits(const std::filesystem::path& file, std::string_view type)
{
    const std::string meant = media_type_of(file);
    return meant.empty() || type.empty() || meant == type.substr(0, type.find(';'));
}

}  // namespace hivectl
