// Determines the kind of a source from its text, and refuses invalid ones.
#include "source.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace camera {
namespace {

namespace fs = std::filesystem;

bool ends_as_image(const fs::path& path)
{
    constexpr std::array suffixes{".jpg",  ".jpeg", ".jpe", ".png", ".bmp", ".dib", ".tif", ".tiff",
                                  ".webp", ".pgm",  ".ppm", ".pbm", ".pnm", ".pxm", ".pam", ".pfm",
                                  ".jp2",  ".hdr",  ".pic", ".ras", ".sr",  ".exr"};
    std::string suffix = path.extension().string();
    std::ranges::transform(suffix, suffix.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::ranges::find(suffixes, suffix) != suffixes.end();
}

/// Every user who queries the parameters or lists the processes would see a password in a URL.
void refuse_credentials(const std::string& url)
{
    const std::size_t begin = url.find("://") + 3;
    const std::string authority = url.substr(begin, url.find_first_of("/?#", begin) - begin);
    if (authority.find('@') != std::string::npos)
        throw std::runtime_error(
            "a URL must not contain a user name or password: anyone who can read the parameters would see it");
    if (authority.empty())
        throw std::runtime_error("the URL has no host");
}

bool is_url(const std::string& text)
{
    const std::size_t colon = text.find("://");
    if (colon == std::string::npos)
        return false;
    const std::string scheme = text.substr(0, colon);
    if (scheme != "http" && scheme != "https" && scheme != "rtsp")
        throw std::runtime_error("URLs of " + scheme + ":// are not supported; http, https and rtsp are");
    return true;
}

void check_scene(const std::string& text)
{
    constexpr std::array<std::string_view, 4> known{"scene", "scene:brick", "scene:noise", "scene:plain"};
    if (std::ranges::find(known, text) == known.end())
        throw std::runtime_error("unknown source " + text + "; use scene:brick, scene:noise or scene:plain");
}

SourceKind file_kind(const std::string& text)
{
    const fs::path path(text);
    std::error_code problem;
    const fs::file_status status = fs::status(path, problem);
    if (!fs::exists(status))
        throw std::runtime_error("no such file: " + fs::absolute(path).string());
    if (fs::is_directory(status))
        return SourceKind::folder;
    if (!fs::is_regular_file(status))
        throw std::runtime_error(text + " is neither a file nor a folder");
    return is_image(path) ? SourceKind::image : SourceKind::video;
}

}  // namespace

bool is_image(const fs::path& file) { return ends_as_image(file) || cv::haveImageReader(file.string()); }

bool is_scene(const std::string& text) { return text == "scene" || text.starts_with("scene:"); }

SourceKind source_kind(const std::string& text)
{
    if (is_scene(text)) {
        check_scene(text);
        return SourceKind::scene;
    }
    if (text.empty())
        throw std::runtime_error("the source is empty; try scene, a file, /dev/video0 or a URL");
    if (is_url(text)) {
        refuse_credentials(text);
        return SourceKind::url;
    }
    if (text.starts_with("/dev/video")) {
        if (!fs::exists(text))
            throw std::runtime_error("no such device: " + text);
        return SourceKind::device;
    }
    return file_kind(text);
}

bool is_format(const std::string& text)
{
    return text.size() <= 4
           && std::ranges::all_of(text, [](unsigned char letter) { return letter < 0x80 && std::isalnum(letter); });
}

std::string shown_source(const std::string& text)
{
    return text.find("://") == std::string::npos ? text : text.substr(0, text.find('?'));
}

}  // namespace camera
