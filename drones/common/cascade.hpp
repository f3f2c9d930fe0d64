// Loads a Haar or LBP cascade.
#pragma once

#include <opencv2/objdetect.hpp>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace cascade {

/// @throws std::runtime_error  with the reason as a sentence
inline cv::CascadeClassifier load(const std::string& path)
{
    if (!std::filesystem::is_regular_file(path))
        throw std::runtime_error("no cascade at " + path + " (Debian: apt install opencv-data)");
    cv::CascadeClassifier loaded;
    bool good = false;
    try {
        good = loaded.load(path);
    } catch (const cv::Exception&) {  // not XML; the error below suffices
    }
    if (!good)
        throw std::runtime_error(path + " is not a cascade");
    return loaded;
}

}  // namespace cascade
