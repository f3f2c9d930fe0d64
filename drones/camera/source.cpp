// Opens every kind of source, and implements those that are files or drawn: scene, image, folder.
#include "source.hpp"

#include "video_source.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace camera {
namespace {

namespace fs = std::filesystem;

std::vector<unsigned char> read_file(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), {}};
    if (!file)
        throw std::runtime_error("cannot read " + path.string());
    return bytes;
}

/// As by cv::imread, except that grey images of 16 bits keep them.
void decode(const std::vector<unsigned char>& bytes, cv::Mat& image)
{
    if (bytes.empty())
        return;
    if (const cv::Mat whole = cv::imdecode(bytes, cv::IMREAD_ANYDEPTH | cv::IMREAD_ANYCOLOR); whole.type() == CV_16UC1)
        whole.copyTo(image);
    else
        cv::imdecode(bytes, cv::IMREAD_COLOR, &image);
}

/// Returns JPEG files unchanged, so that they can be forwarded; decodes everything else.
Frame read_image(const fs::path& path, cv::MatAllocator* memory)
{
    Frame frame;
    frame.image.allocator = memory;
    frame.file = path.string();
    frame.captured = std::chrono::system_clock::now();
    auto bytes = read_file(path);
    if (bytes.size() >= 2 && bytes[0] == 0xFF && bytes[1] == 0xD8) {
        frame.jpeg = std::make_shared<const std::vector<unsigned char>>(std::move(bytes));
        return frame;
    }
    decode(bytes, frame.image);
    if (frame.image.empty())
        throw std::runtime_error(path.string() + " is not a readable image");
    return frame;
}

class SceneSource : public Source {
public:
    SceneSource(const SceneSettings& settings, cv::MatAllocator* memory) : scene_(settings), memory_(memory) {}

    std::optional<Frame> next() override
    {
        Frame frame;
        frame.captured = std::chrono::system_clock::now();
        frame.index = index_++;
        SceneFrame drawn = scene_.frame(frame.index, memory_);
        frame.image = std::move(drawn.image);
        frame.truth = std::move(drawn.truth);
        frame.hands = std::move(drawn.hands);
        frame.knows_truth = true;
        return frame;
    }

private:
    Scene scene_;
    cv::MatAllocator* memory_;
    std::int64_t index_ = 0;
};

/// Image files one after the other; one file is a folder of one.
class FileSource : public Source {
public:
    FileSource(std::vector<fs::path> files, bool loop, cv::MatAllocator* memory, const std::string& skipped = "")
        : files_(std::move(files)), loop_(loop), memory_(memory)
    {
        if (!skipped.empty())
            tell(skipped);
    }

    std::optional<Frame> next() override
    {
        if (index_ == files_.size() && loop_)
            index_ = 0;
        if (index_ == files_.size())
            return std::nullopt;
        const std::size_t index = index_++;  // a file that cannot be read is passed over at the next call
        Frame frame = read_image(files_[index], memory_);
        frame.index = static_cast<std::int64_t>(index);
        return frame;
    }

    [[nodiscard]] std::int64_t count() const override { return loop_ ? 0 : std::ssize(files_); }

private:
    std::vector<fs::path> files_;
    bool loop_;
    cv::MatAllocator* memory_;
    std::size_t index_ = 0;
};

/// "images: skipped, because OpenCV cannot read them: a.heic, notes.txt and 1 more"
std::string sentence_about(const fs::path& folder, const std::vector<fs::path>& skipped)
{
    constexpr std::size_t max_named = 5;
    if (skipped.empty())
        return "";
    std::string text = folder.string() + ": skipped, because OpenCV cannot read them: ";
    for (std::size_t i = 0; i < std::min(skipped.size(), max_named); ++i)
        text += (i > 0 ? ", " : "") + skipped[i].filename().string();
    if (skipped.size() > max_named)
        text += " and " + std::to_string(skipped.size() - max_named) + " more";
    return text;
}

bool hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

std::unique_ptr<Source> open_folder(const fs::path& folder, bool loop, cv::MatAllocator* memory)
{
    std::vector<fs::path> files, skipped;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && !hidden(entry.path()))
            (is_image(entry.path()) ? files : skipped).push_back(entry.path());
    std::ranges::sort(files);
    std::ranges::sort(skipped);
    const auto sentence = sentence_about(folder, skipped);
    if (files.empty())
        throw std::runtime_error("no images in " + fs::absolute(folder).string()
                                 + (sentence.empty() ? "" : "; " + sentence));
    return std::make_unique<FileSource>(std::move(files), loop, memory, sentence);
}

std::unique_ptr<Source> open_scene(const SourceSettings& settings, cv::MatAllocator* memory)
{
    SceneSettings scene = settings.scene;
    scene.size = size_or_default(settings.size);
    if (settings.text == "scene:noise")
        scene.background = Background::noise;
    else if (settings.text == "scene:plain")
        scene.background = Background::plain;
    else
        scene.background = Background::brick;
    return std::make_unique<SceneSource>(scene, memory);
}

}  // namespace

cv::Size size_or_default(cv::Size size)
{
    if (size.width <= 0 && size.height <= 0)
        return {640, 480};
    if (size.width <= 0)
        size.width = size.height * 4 / 3;
    if (size.height <= 0)
        size.height = size.width * 3 / 4;
    return size;
}

std::unique_ptr<Source> open_source(const SourceSettings& settings, cv::MatAllocator* memory)
{
    switch (source_kind(settings.text)) {
    case SourceKind::scene: return open_scene(settings, memory);
    case SourceKind::image:
        return std::make_unique<FileSource>(std::vector<fs::path>{settings.text}, settings.loop, memory);
    case SourceKind::folder: return open_folder(settings.text, settings.loop, memory);
    case SourceKind::video: return open_video(settings.text, settings.loop, memory);
    case SourceKind::device:
        return open_device(settings.text, {settings.format, size_or_default(settings.size), settings.fps}, memory);
    case SourceKind::url: return open_url(url_settings(settings), memory);
    }
    throw std::logic_error("unhandled kind of source");
}

}  // namespace camera
