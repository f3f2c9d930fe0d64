// Finds, creates and compares the media of vision tests.
#include "media.hpp"

#include <doctest/doctest.h>
#include <possible.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace media {

namespace fs = std::filesystem;

std::optional<fs::path> shared(const std::string& name)
{
    const char* told = std::getenv("HIVE_SHARED");
    const fs::path path = (told ? fs::path(told) : fs::path(HIVE_SOURCE_DIR).parent_path() / "shared") / name;
    if (fs::exists(path))
        return path;
    hive::test::possible(name + " in the folder that HIVE_SHARED names");
    return std::nullopt;
}

std::vector<fs::path> images(const std::vector<std::string>& suffixes)
{
    std::vector<fs::path> found;
    if (const auto folder = shared("media"))
        for (const auto& entry : fs::directory_iterator(*folder))
            if (std::ranges::find(suffixes, entry.path().extension().string()) != suffixes.end())
                found.push_back(entry.path());
    std::ranges::sort(found);
    return found;
}

std::vector<cv::Rect2d> boxes(const std::vector<TrueBox>& things)
{
    std::vector<cv::Rect2d> result;
    std::ranges::transform(things, std::back_inserter(result), &TrueBox::box);
    return result;
}

Bytes read(const fs::path& path)
{
    std::ifstream file(path, std::ios::binary);
    REQUIRE(file);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write(const fs::path& path, const Bytes& bytes)
{
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    REQUIRE(file.flush());
}

cv::Mat sample(cv::Size size, int type, int seed)
{
    cv::RNG random(static_cast<std::uint64_t>(seed));
    cv::Mat cells(5, 6, CV_8UC(CV_MAT_CN(type))), image, grain(size, CV_8UC(CV_MAT_CN(type)));
    random.fill(cells, cv::RNG::UNIFORM, 0, 200);
    cv::resize(cells, image, size, 0, 0, cv::INTER_CUBIC);
    cv::circle(image, {size.width / 2, size.height / 2}, size.height / 3, cv::Scalar(250, 20, 90), 3);
    random.fill(grain, cv::RNG::UNIFORM, 0, 30);
    image += grain;
    if (CV_MAT_DEPTH(type) == CV_16U)
        image.convertTo(image, CV_16U, 257);
    return image;
}

Bytes encoded(const char* suffix, const cv::Mat& image, const std::vector<int>& options)
{
    Bytes bytes;
    REQUIRE(cv::imencode(suffix, image, bytes, options));
    return bytes;
}

bool same(const cv::Mat& a, const cv::Mat& b)
{
    return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

Folder::Folder()
{
    std::string pattern = (fs::temp_directory_path() / "hive-test-XXXXXX").string();
    REQUIRE(mkdtemp(pattern.data()));
    path_ = pattern;
}

Folder::~Folder()
{
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

}  // namespace media
