// A folder of images, with a table of their times.
#pragma once

#include "sink.hpp"

#include <fstream>

namespace writing {

/// Files 00000001.jpg and so on. JPEG and PNG files are written unchanged; images of 16 bits, and raw ones at quality
/// 100, as PNG; the rest as JPEG. `times.csv` has the time of each.
class ImageFolder final : public Sink {
public:
    explicit ImageFolder(Settings settings) : settings_(std::move(settings)) {}

    void add(const Image& image, std::chrono::microseconds time) override;
    void close() override;
    [[nodiscard]] bool takes_encoded(const std::string& extension) const override
    {
        return extension == ".jpg" || extension == ".png";
    }
    [[nodiscard]] std::string encoder() const override { return count_ > 0 ? "pictures" : ""; }

private:
    void begin();
    [[nodiscard]] std::string extension_for(const Image& image) const;

    Settings settings_;
    std::ofstream times_;
    std::int64_t count_ = 0;
};

}  // namespace writing
