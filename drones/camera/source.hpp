// One interface for all sources of images: the scene, files, folders, videos, devices and network cameras.
#pragma once

#include "scene.hpp"

#include <opencv2/core/mat.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace camera {

/// One image of a source: pixels, or the unchanged bytes of a JPEG file.
struct Frame {
    cv::Mat image;                                           ///< BGR or grey, grey also of 16 bits; empty with `jpeg`
    std::shared_ptr<const std::vector<unsigned char>> jpeg;  ///< a whole JPEG file, not checked
    std::vector<Truth> truth;                                ///< of the scene: what was drawn, and where
    std::vector<DrawnHand> hands;                            ///< of the scene
    bool knows_truth = false;
    std::int64_t index = 0;                               ///< in the source, from 0; restarts when the source is looped
    std::string file;                                     ///< where it was read; empty: elsewhere
    std::optional<std::chrono::microseconds> media_time;  ///< its own time in a video
    double fps = 0;                                       ///< of that video or device; 0: unknown
    std::string device;                                   ///< the mode that the device reports
    bool restarts = false;                                ///< the first frame of a repetition of a video
    std::chrono::system_clock::time_point captured{};
};

enum class SourceKind { scene, image, folder, video, device, url };

struct SourceSettings {
    std::string text = "scene";  ///< scene, scene:brick|noise|plain, a path, /dev/videoN, http(s):// or rtsp://
    cv::Size size{0, 0};         ///< of the scene, and requested from a device; 0: 640 and 480. Not for files and URLs
    double fps = 0;              ///< requested from a device; 0: driver default
    bool loop = true;            ///< play files in a loop
    SceneSettings scene;         ///< its size and background are taken from above
    std::string credentials = {};   ///< of a network camera: a file with user:password; empty: of the environment
    std::string transport = "tcp";  ///< of RTSP
    bool basic_over_http = false;   ///< of a network camera: may the password be sent unencrypted?
    std::string certificate = {};   ///< of https: file of the certificate to trust; empty: those of the system
    std::string format = {};        ///< requested from a device: four letters, "MJPG"; empty: driver default

    bool operator==(const SourceSettings&) const = default;
};

/// For one thread at a time.
class Source {
public:
    virtual ~Source() = default;
    /// The next image; nothing at the end. A device or a URL waits for it, at most about 2 s.
    /// @throws std::runtime_error  naming the unreadable input
    virtual std::optional<Frame> next() = 0;
    /// The source's own rate in images per second; 0 if it has none.
    [[nodiscard]] virtual double fps() const { return 0; }
    /// How many images it has in all, exactly after the last one; 0: unknown, or no end.
    [[nodiscard]] virtual std::int64_t count() const { return 0; }
    /// Messages about the source, each sentence once: omitted files, missing parts.
    std::vector<std::string> news() { return std::exchange(news_, {}); }
    /// At the end: why it came too early; empty if it did not.
    [[nodiscard]] virtual std::string cut_short() const { return ""; }

protected:
    void tell(std::string sentence) { news_.push_back(std::move(sentence)); }

private:
    std::vector<std::string> news_;
};

/// A camera refused the login: repeated attempts may lock the user out.
class LoginRefused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The kind of source by its text, without opening it (files are checked, devices and networks are not queried).
/// @throws std::runtime_error  for an invalid source: no such file, an unknown keyword, a URL with a password
SourceKind source_kind(const std::string& text);

/// Is this file an image that OpenCV reads, by its name, or else by its first bytes?
bool is_image(const std::filesystem::path& file);

/// Is it drawn? True for any text of a scene, even an unknown one.
bool is_scene(const std::string& text);

/// Can this be the name of a device's format? So can an empty one, which means any.
bool is_format(const std::string& text);

/// Does it have its own fixed rate?
inline bool is_live(SourceKind kind) { return kind == SourceKind::device || kind == SourceKind::url; }

/// @param memory  where the pixels of its images shall lie (kept, for the source's thread); null: OpenCV's own
/// @throws std::runtime_error  naming what is missing
std::unique_ptr<Source> open_source(const SourceSettings& settings, cv::MatAllocator* memory = nullptr);

/// The text for display: a URL without the part after `?`.
std::string shown_source(const std::string& text);

}  // namespace camera
