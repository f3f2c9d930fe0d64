// The interface for writing images: a video or a folder.
#pragma once

#include <opencv2/core/mat.hpp>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace writing {

struct Settings {
    std::string path;
    bool overwrite = false;
    int quality = 80;  ///< 1 to 100
};

/// One image: its pixels, or its encoded bytes if they can be written unchanged.
struct Image {
    cv::Mat pixels;                               ///< BGR or grey, 8 bit, or grey of 16 bits; empty with `encoded`
    std::span<const unsigned char> encoded = {};  ///< a whole JPEG or PNG file
    std::string extension = {};                   ///< of that: ".jpg"
    std::int64_t sequence = 0;
    double fps = 0;  ///< of its source; 0: unknown
};

/// The content of a finished file.
struct Held {
    std::int64_t images = 0;
    std::chrono::microseconds last{0};  ///< the time of the last one
};

/// For one thread.
class Sink {
public:
    virtual ~Sink() = default;
    /// @param time  since the first image; larger each time
    /// @throws std::runtime_error  with the error of the system or the encoder; then nothing more can be written
    virtual void add(const Image& image, std::chrono::microseconds time) = 0;
    /// Completes the file. @throws std::runtime_error  earlier images are still in it
    virtual void close() = 0;
    /// Can an image of this kind be written without its pixels?
    [[nodiscard]] virtual bool takes_encoded(const std::string& extension) const = 0;
    /// After a failure, the readable content: buffered images may be lost. Nothing if each was written at once.
    [[nodiscard]] virtual std::optional<Held> held() const { return std::nullopt; }
    /// The encoder: "libx264"; empty before the first image.
    [[nodiscard]] virtual std::string encoder() const = 0;
};

/// A video for .mp4, .m4v, .mov, .mkv and .avi, otherwise a folder: a path that ends in `/`, or is a folder already.
/// Creates nothing before the first image.
/// @throws std::runtime_error  unknown extension, the file exists, or its folder does not
std::unique_ptr<Sink> open_sink(const Settings& settings);

}  // namespace writing
