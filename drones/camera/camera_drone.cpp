// Maps parameters to sources, and images to events.
#include "camera_drone.hpp"

#include <certificate_file.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace camera {
namespace {

using namespace std::chrono_literals;

constexpr double default_fps = 30;  ///< of the scene and of images

/// The size an image of size `own` is sent with; a side of 0 follows the other, or stays as it is. Throws
/// Errc::too_large when receivers would refuse it.
cv::Size size_to_send(cv::Size own, int width, int height)
{
    const double ratio = static_cast<double>(own.width) / own.height;
    if (width == 0)
        width = height == 0 ? own.width : std::max(1, static_cast<int>(std::lround(height * ratio)));
    if (height == 0)
        height = width == own.width ? own.height : std::max(1, static_cast<int>(std::lround(width / ratio)));
    if (std::int64_t{width} * height > hive::vision::DecodeLimits().pixels && cv::Size(width, height) != own)
        throw hive::Error(hive::Errc::too_large,
                          std::to_string(width) + "x" + std::to_string(height) + " px are more than 40 Mpixel");
    return {width, height};
}

hive::Body body_of(const std::shared_ptr<const std::vector<unsigned char>>& jpeg)
{
    return {std::as_bytes(std::span(*jpeg)), jpeg};
}

hive::Json truth_of(const Frame& frame)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    hive::Json boxes = hive::Json::array();
    for (const auto& [kind, id, box] : frame.truth)
        boxes.push_back({{"kind", kind},
                         {"id", id},
                         {"x", tenths(box.x)},
                         {"y", tenths(box.y)},
                         {"w", tenths(box.width)},
                         {"h", tenths(box.height)}});
    return boxes;
}

hive::Json hands_of(const Frame& frame)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    hive::Json hands = hive::Json::array();
    for (const DrawnHand& hand : frame.hands)
        hands.push_back(
            {{"fingers", hand.fingers},
             {"angle", tenths(hand.rotation)},
             {"palm", {{"x", tenths(hand.palm.x)}, {"y", tenths(hand.palm.y)}, {"radius", tenths(hand.radius)}}}});
    return hands;
}

}  // namespace

CameraDrone::CameraDrone(hive::Drone& drone)
    : drone_(drone),
      image_(drone.output("image", hive::vision::image_types, "the images", hive::vision::encoder())),
      memory_(std::make_shared<hive::vision::LoanAllocator>(
          [output = image_](std::size_t bytes) { return output.loan(bytes); }))
{
    declare();
    drone_.on_start([] {
        cv::setNumThreads(1);                                                  // one drone, one core
        cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_ERROR);  // relevant errors are exceptions
    });
    drone_.on_change([this] { apply(); });
    drone_.main([this] { return step(); });
}

void CameraDrone::declare()
{
    drone_.parameter("source", source_, hive::anything().by_operator(),
                     "scene, scene:brick|noise|plain, an image file, a folder of images, a video, /dev/videoN, "
                     "http(s):// or rtsp://");
    drone_.parameter("width", width_, hive::between(0, 8192).in("px"),
                     "output width; 0: from height and aspect ratio, or the source's (scene, device: 640)");
    drone_.parameter("height", height_, hive::between(0, 8192).in("px"),
                     "output height; 0: from width and aspect ratio, or the source's (scene, device: 480)");
    drone_.parameter("fps", fps_, hive::between(0, 1000).in("fps"),
                     "frame rate with pace=live; 0: the source's (scene and images: 30)");
    drone_.parameter("loop", loop_, hive::anything(), "play files in a loop");
    drone_.parameter("pace", pace_, hive::one_of({"live", "demand"}),
                     "live: never wait; demand: publish an image when all receivers have asked");
    drone_.parameter(
        "credentials", credentials_, hive::anything().by_operator(),
        "network camera login: file with user:password, chmod 600; empty: HIVE_CAMERA_USER and HIVE_CAMERA_PASSWORD");
    drone_.parameter("transport", transport_, hive::one_of({"tcp", "udp"}),
                     "rtsp:// transport: tcp is reliable; udp skips lost packets");
    drone_.parameter("basic_over_http", basic_over_http_, hive::anything().by_operator(),
                     "send the password unencrypted if an http:// or rtsp:// camera does not support digest "
                     "authentication");
    drone_.parameter("certificate", certificate_, hive::anything().by_operator(),
                     "https://: the only certificate to trust (a file); empty: the system's");
    drone_.parameter("format", format_, hive::anything(),
                     "device pixel format: MJPG, YUYV, ... (see hivectl devices); empty: driver default");
    drone_.parameter("faces", faces_, hive::between(0, 3), "number of faces in the scene");
    drone_.parameter("walkers", walkers_, hive::between(0, 4), "number of people walking through the scene");
    drone_.parameter("hand", hand_, hive::anything(), "draw a hand with a changing number of fingers");
    drone_.parameter("noise", noise_, hive::between(0, 50), "scene noise: standard deviation in grey levels");
    drone_.parameter("seed", seed_, hive::at_least(0), "scene seed: the same seed draws the same images");
}

CameraDrone::Wanted CameraDrone::wanted() const
{
    Wanted wanted{{source_,
                   {width_, height_},
                   fps_,
                   loop_,
                   {},
                   credentials_,
                   transport_,
                   basic_over_http_,
                   certificate_,
                   format_},
                  fps_,
                  pace_};
    if (!is_scene(source_))
        return wanted;  // parameters of the scene do not reopen a file or a camera
    wanted.source.scene.faces = faces_;
    wanted.source.scene.walkers = walkers_;
    wanted.source.scene.hand = hand_;
    wanted.source.scene.noise = noise_;
    wanted.source.scene.seed = static_cast<std::uint64_t>(seed_);
    return wanted;
}

void CameraDrone::apply()
{
    const Wanted now = wanted();
    if (opened_ == now && !(capture_ && capture_->gave_up()))
        return;
    open(now);
    // The same scene with other things in it is the same source.
    if (opened_ && !(is_scene(source_) && opened_->source.text == source_))
        image_.begin_source();
    opened_ = now;
    say("");
}

/// Opens sources that do not block, so that an error refuses the `set`; the capture's thread opens devices and network
/// cameras, and retries.
void CameraDrone::open(const Wanted& wanted)
{
    const SourceKind kind = source_kind(wanted.source.text);
    if (!is_format(wanted.source.format))
        throw hive::Error(hive::Errc::refused, "unknown format " + wanted.source.format,
                          "it has at most four letters and digits: MJPG; see those of a camera: hivectl devices");
    capture::check_certificate(wanted.source.certificate);
    if (wanted.pace == "demand" && is_live(kind))
        throw hive::Error(hive::Errc::refused, "pace=demand works only with files and the scene, not with cameras");
    auto source = is_live(kind) ? nullptr : open_source(wanted.source, memory_.get());
    on_demand_.reset();
    capture_.reset();
    ended_ = false;
    reported_.clear();
    drone_.source_events(source ? source->count() : 0);
    if (wanted.pace == "demand")
        on_demand_ = std::move(source);
    else
        capture_ = std::make_unique<Capture>(
            [settings = wanted.source, memory = memory_] { return open_source(settings, memory.get()); }, wanted.fps,
            is_live(kind) ? Capture::AtEnd::open_again : Capture::AtEnd::stop, [this] { drone_.wake(); },
            kind == SourceKind::url ? "connecting to " + shown_source(wanted.source.text) : "");
    if (capture_)
        say(capture_->condition());
}

std::chrono::microseconds CameraDrone::step() { return capture_ ? step_live() : step_on_demand(); }

/// Checks twice a second even without an image, to detect a stall.
std::chrono::microseconds CameraDrone::step_live()
{
    const bool ended = capture_->ended();  // if so, the next one taken is the last
    const auto frame = capture_->take();
    if (!ended)
        say(capture_->condition());
    report(capture_->problems());
    if (frame)
        send(*frame, false);
    if (ended)
        end(capture_->cut_short());
    return 500ms;
}

/// An unreadable file has a number in the sequence, so that no receiver waits for it.
std::chrono::microseconds CameraDrone::step_on_demand()
{
    if (!on_demand_ || !image_.asked())
        return 1s;
    const auto captured = std::chrono::system_clock::now();
    std::optional<Frame> frame;
    try {
        frame = on_demand_->next();
    } catch (const std::exception& problem) {
        return lack(captured, true, hive::Errc::failed, problem.what());
    }
    report(on_demand_->news());
    if (frame)
        return send(*frame, true);
    drone_.source_events(on_demand_->count());
    end(std::exchange(on_demand_, nullptr)->cut_short());
    return 1s;
}

void CameraDrone::end(const std::string& cut_short)
{
    if (std::exchange(ended_, true))
        return;
    if (!cut_short.empty())
        report({cut_short});
    say("end of source" + (cut_short.empty() ? "" : "; " + cut_short), hive::Reason::source_ended);
    image_.end(cut_short);
}

/// The same for a file that cannot be decoded.
std::chrono::microseconds CameraDrone::send(const Frame& frame, bool lossless)
{
    if (frame.restarts)
        image_.begin_source();
    const auto named = [&](const char* problem) { return (frame.file.empty() ? "" : frame.file + ": ") + problem; };
    try {
        emit(frame, lossless);
        return 0s;
    } catch (const hive::Error& problem) {
        return lack(frame.captured, lossless, problem.code(), named(problem.what()));
    } catch (const std::exception& problem) {
        return lack(frame.captured, lossless, hive::Errc::failed, named(problem.what()));
    }
}

/// Reports why there is no image; for a looped file, only the first time.
std::chrono::microseconds CameraDrone::lack(std::chrono::system_clock::time_point captured, bool lossless,
                                            hive::Errc code, const std::string& text)
{
    if (is_news(text))
        image_.fail(captured, lossless, code, text);
    return 10ms;  // a source with only such images must not spin
}

bool CameraDrone::is_news(const std::string& text)
{
    constexpr std::size_t most = 10'000;
    return reported_.size() < most && reported_.insert(text).second;
}

void CameraDrone::report(const std::vector<std::string>& sentences)
{
    for (const auto& sentence : sentences)
        if (is_news(sentence))
            drone_.report(hive::Errc::failed, sentence);
}

/// A JPEG that is not resized is sent unchanged; everything else as pixels, which connections may encode.
void CameraDrone::emit(const Frame& frame, bool lossless)
{
    const cv::Size own = frame.jpeg ? hive::vision::size_of(body_of(frame.jpeg), "image/jpeg") : frame.image.size();
    const cv::Size size = size_to_send(own, width_, height_);
    const bool untouched = frame.jpeg && size == own;
    const auto form = untouched
                          ? hive::vision::PlainForm{"image/jpeg", {{"width", size.width}, {"height", size.height}}}
                          : hive::vision::plain_form(size, frame.jpeg ? 3 : frame.image.channels(),
                                                     frame.image.depth() == CV_16U ? 16 : 8);
    hive::Json header = form.header;
    header.update(about(frame));
    image_.emit_captured(
        frame.captured, lossless, std::move(header),
        [&] { return untouched ? body_of(frame.jpeg) : pixels(frame, form, size); }, form.type);
}

/// The fields of the header besides the image format.
hive::Json CameraDrone::about(const Frame& frame) const
{
    hive::Json header{{"index", frame.index}, {"source", shown_source(source_)}};
    if (frame.knows_truth)
        header["truth"] = truth_of(frame);
    if (hand_ && frame.knows_truth)
        header["hands"] = hands_of(frame);
    if (!frame.file.empty())
        header["file"] = frame.file;
    if (!frame.device.empty())
        header["device"] = frame.device;
    if (frame.fps > 0)
        header["fps"] = frame.fps;
    if (frame.media_time)
        header["media_time_us"] = frame.media_time->count();
    else if (frame.knows_truth || (fps_ > 0 && !loop_ && !frame.file.empty()))  // drawn or shown frame by frame
        header["media_time_us"] =
            std::llround(static_cast<double>(frame.index) / (fps_ > 0 ? fps_ : default_fps) * 1e6);
    return header;
}

hive::Body CameraDrone::pixels(const Frame& frame, const hive::vision::PlainForm& form, cv::Size size)
{
    const cv::Mat image = frame.jpeg ? hive::vision::decode(body_of(frame.jpeg), "image/jpeg") : frame.image;
    if (image.size() == size)
        return form.body(image);
    cv::Mat resized = memory_->image();
    cv::resize(image, resized, size, 0, 0, size.area() < image.size().area() ? cv::INTER_AREA : cv::INTER_LINEAR);
    return form.body(resized);
}

void CameraDrone::say(const std::string& condition, hive::Reason why)
{
    if (condition == condition_)
        return;
    condition_ = condition;
    drone_.condition(condition, why, why == hive::Reason::none ? hive::LogLevel::warning : hive::LogLevel::info);
}

}  // namespace camera
