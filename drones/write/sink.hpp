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
struct Picture {
    cv::Mat pixels;                               ///< BGR or grey, 8 bit, or grey of 16 bits; empty with `encoded`
    std::span<const unsigned char> encoded = {};  ///< a whole JPEG or PNG file
    std::string ending = {};                      ///< of that: ".jpg"
    std::int64_t sequence = 0;
    double fps = 0;  ///< of its source; 0: unknown
};

/// The content of a finished file.
struct Held {
    std::int64_t pictures = 0;
    std::chrono::microseconds last{0};  ///< the time of the last one
};

/// For one thread.
class Sink {
public:
    virtual ~Sink() = default;
    /// @param time  since the first image; larger each time
    /// @throws std::runtime_error  saying what the system or the encoder refused; nothing more can be written then
    virtual void add(const Picture& picture, std::chrono::microseconds time) = 0;
    /// Completes it. @throws std::runtime_error  what came before is there all the same
    virtual void close() = 0;
    /// Can an image of this kind be written without its pixels?
    [[nodiscard]] virtual bool takes_encoded(const std::string& ending) const = 0;
    /// After a failure, what can be read: images may have been lost with what was not yet written. Nothing if each
    /// was written at once.
    [[nodiscard]] virtual std::optional<Held> held() const { return std::nullopt; }
    /// By what the images are encoded: "libx264"; empty before the first.
    [[nodiscard]] virtual std::string encoder() const = 0;
};

/// A video for .mp4, .m4v, .mov, .mkv and .avi, otherwise a folder: a path that ends in `/`, or is a folder already.
/// Nothing is made before the first image comes.
/// @throws std::runtime_error  the ending means nothing, there is such a file already, or no folder to put it into
std::unique_ptr<Sink> open_sink(const Settings& settings);

}  // namespace writing
