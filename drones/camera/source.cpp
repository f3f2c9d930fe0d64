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

/// JPEG files are given as they are, for whoever passes them on; everything else is decoded here.
Frame read_picture(const fs::path& path, cv::MatAllocator* memory)
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
    if (!bytes.empty())
        cv::imdecode(bytes, cv::IMREAD_COLOR, &frame.image);
    if (frame.image.empty())
        throw std::runtime_error(path.string() + " is not a picture, or damaged");
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
        ScenePicture picture = scene_.picture(frame.index, memory_);
        frame.image = std::move(picture.image);
        frame.truth = std::move(picture.truth);
        frame.hands = std::move(picture.hands);
        frame.knows_truth = true;
        return frame;
    }

private:
    Scene scene_;
    cv::MatAllocator* memory_;
    std::int64_t index_ = 0;
};

/// Picture files one after the other; one file is a folder of one.
class FileSource : public Source {
public:
    FileSource(std::vector<fs::path> files, bool loop, cv::MatAllocator* memory)
        : files_(std::move(files)), loop_(loop), memory_(memory)
    {
    }

    std::optional<Frame> next() override
    {
        if (index_ == files_.size() && loop_)
            index_ = 0;
        if (index_ == files_.size())
            return std::nullopt;
        const std::size_t index = index_++;  // a file that cannot be read is passed over at the next call
        Frame frame = read_picture(files_[index], memory_);
        frame.index = static_cast<std::int64_t>(index);
        return frame;
    }

private:
    std::vector<fs::path> files_;
    bool loop_;
    cv::MatAllocator* memory_;
    std::size_t index_ = 0;
};

std::vector<fs::path> pictures_in(const fs::path& folder)
{
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && source_kind(entry.path().string()) == SourceKind::image)
            files.push_back(entry.path());
    if (files.empty())
        throw std::runtime_error("no pictures in " + fs::absolute(folder).string());
    std::ranges::sort(files);
    return files;
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
    case SourceKind::folder: return std::make_unique<FileSource>(pictures_in(settings.text), settings.loop, memory);
    case SourceKind::video: return open_video(settings.text, settings.loop, memory);
    case SourceKind::device: return open_device(settings.text, size_or_default(settings.size), settings.fps, memory);
    case SourceKind::url: return open_url(settings.text, memory);
    }
    throw std::logic_error("a kind of source that nobody opens");
}

}  // namespace camera
