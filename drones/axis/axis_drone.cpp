// Maps parameters to names of VAPIX, and images to events.
#include "axis_drone.hpp"

#include <certificate_file.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>

#include <charconv>

namespace axis {
namespace {

using namespace std::chrono_literals;

constexpr const char* resolution_name = "Image.I0.Appearance.Resolution";
constexpr const char* compression_name = "Image.I0.Appearance.Compression";
constexpr const char* fps_name = "Image.I0.Stream.FPS";
constexpr const char* exposure_name = "ImageSource.I0.Sensor.Exposure";
constexpr const char* brightness_name = "ImageSource.I0.Sensor.Brightness";
constexpr const char* colour_name = "ImageSource.I0.Sensor.ColorLevel";
constexpr auto max_set_time = 4s;

Size measure(const std::string& jpeg)
{
    if (!jpeg.starts_with("\xFF\xD8") || !jpeg.ends_with("\xFF\xD9"))
        throw std::runtime_error(jpeg.starts_with("\xFF\xD8") ? "it is cut short" : "not a JPEG");
    const hive::Body view(std::as_bytes(std::span(jpeg)), nullptr);
    const cv::Size size = hive::vision::size_of(view, "image/jpeg");
    return {size.width, size.height};
}

void read_back(const Parameters& applied, const char* name, std::string& variable)
{
    if (const auto found = applied.find(name); found != applied.end())
        variable = found->second;
}

void read_back(const Parameters& applied, const char* name, int& variable)
{
    const auto found = applied.find(name);
    if (found == applied.end())
        return;
    const std::string& text = found->second;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), variable);
    if (problem != std::errc() || end != text.data() + text.size())
        throw hive::Error(hive::Errc::refused, std::string("the camera has no number in ") + name);
}

/// The values that differ from `before`.
Parameters changes(const Parameters& before, const Parameters& now)
{
    Parameters result;
    for (const auto& [name, value] : now)
        if (const auto old = before.find(name); old == before.end() || old->second != value)
            result[name] = value;
    return result;
}

}  // namespace

AxisDrone::AxisDrone(hive::Drone& drone)
    : drone_(drone),
      image_(
          drone.output("image", hive::vision::image_types, "the camera's images, unchanged", hive::vision::encoder()))
{
    declare();
    drone_.on_start([] { cv::setNumThreads(1); });  // one drone, one core
    drone_.on_change([this] { apply(); });
    drone_.main([this] { return step(); });
}

void AxisDrone::declare()
{
    place_.pace = "live";
    drone_.parameter("url", place_.url, hive::anything().by_operator(),
                     "http:// or https:// and the host of the camera; empty: no camera");
    drone_.parameter("credentials", place_.credentials, hive::anything().by_operator(),
                     "file with user:password, and the url in the next line, chmod 600; empty: HIVE_AXIS_USER and "
                     "HIVE_AXIS_PASSWORD");
    drone_.parameter("pace", place_.pace, hive::one_of({"live", "demand"}),
                     "live: the camera's stream; demand: one image each time all receivers have asked");
    drone_.parameter("resolution", resolution_, hive::anything(),
                     "for example 640x480; empty: keep the camera's setting");
    drone_.parameter("compression", compression_, hive::between(-1, 100),
                     "higher: smaller images; -1: keep the camera's setting");
    drone_.parameter("fps", fps_, hive::between(-1, 100).in("fps"),
                     "frame rate of the stream; 0: the camera's maximum; -1: keep the camera's setting");
    drone_.parameter("exposure", exposure_, hive::anything(),
                     "auto, hold, flickerfree50, flickerfree60 ...; empty: keep the camera's setting");
    drone_.parameter("brightness", brightness_, hive::between(-1, 100), "-1: keep the camera's setting");
    drone_.parameter("colour", colour_, hive::between(-1, 100), "0 is grey; -1: keep the camera's setting");
    drone_.parameter("basic_over_http", place_.basic_over_http, hive::anything().by_operator(),
                     "send the password unencrypted if the camera does not support digest authentication");
    drone_.parameter("certificate", place_.certificate, hive::anything().by_operator(),
                     "the only certificate to trust for https (a file); empty: the system's");
    drone_.parameter("allow_address", place_.allow_address, hive::anything().by_operator(),
                     "loopback, link-local or multicast addresses that the drone may connect to, separated by commas");
}

Parameters AxisDrone::wanted() const
{
    Parameters wanted;
    for (const auto& [name, text] : {std::pair(resolution_name, resolution_), {exposure_name, exposure_}})
        if (!text.empty())
            wanted[name] = text;
    for (const auto& [name, number] : {std::pair(compression_name, compression_),
                                       {fps_name, fps_},
                                       {brightness_name, brightness_},
                                       {colour_name, colour_}})
        if (number >= 0)
            wanted[name] = std::to_string(number);
    return wanted;
}

Access AxisDrone::access() const
{
    return {parse_camera_url(place_.url), read_credentials(place_.credentials), place_.basic_over_http,
            place_.certificate, AddressRule(place_.allow_address)};
}

/// A login is sent only to the camera in its file, or else to the one with which the drone was started, and not to one
/// that is set later, perhaps from another machine.
void AxisDrone::require_own_login(const Access& access) const
{
    if (!access.credentials)
        return;
    const auto& named = access.credentials->camera;
    const bool own = named.empty() ? place_.url == started_->url && place_.credentials == started_->credentials
                                   : named == access.url.text();
    if (!own)
        throw hive::Error(
            hive::Errc::refused,
            "the login was given for " + (named.empty() ? "another camera" : named) + ", not for " + access.url.text(),
            "write " + access.url.text() + " into the second line of its file, or start another drone for this camera");
}

void AxisDrone::apply()
try {
    change();
    refused_ = false;
} catch (...) {
    refused_ = true;
    throw;
}

/// Another place: a new link, which configures the camera once it is connected. Otherwise the camera is configured
/// here, so that its refusal refuses the `set`. A `set` that changes nothing is a retry.
void AxisDrone::change()
{
    if (opened_ != place_)
        return open();
    if (link_ && applied_ == wanted() && !refused_)
        link_->once_more();
    else if (link_)
        configure_camera(changes(applied_, wanted()));
    applied_ = wanted();
}

void AxisDrone::open()
{
    capture::check_certificate(place_.certificate);
    if (!started_)
        started_ = place_;
    std::optional<Access> found;
    if (!place_.url.empty())
        found = access();
    else
        AddressRule(place_.allow_address);
    if (found)
        require_own_login(*found);
    link_.reset();
    applied_ = wanted();
    if (opened_ && opened_->url != place_.url)
        image_.begin_source();
    if (found)
        link_ = std::make_unique<CameraLink>(
            LinkSettings{std::move(*found), place_.credentials, place_.pace == "live" ? Pace::live : Pace::demand,
                         applied_},
            LinkHooks{[this] { drone_.wake(); },
                      [this](const std::string& text) { drone_.log(text, hive::LogLevel::debug); }, measure});
    opened_ = place_;
}

void AxisDrone::configure_camera(const Parameters& changed)
{
    if (changed.empty())
        return link_->wanted(wanted());
    if (link_->login_refused())
        throw hive::Error(hive::Errc::refused, link_->condition());
    const auto until = std::chrono::steady_clock::now() + max_set_time;
    Camera camera(access(), [until] {
        if (std::chrono::steady_clock::now() > until)
            throw CameraError(Failure::silent, "the camera took too long");
    });
    take_over(camera.apply(changed));
    link_->wanted(wanted());
    if (changed.contains(resolution_name) || changed.contains(compression_name) || changed.contains(fps_name))
        link_->restart();
}

/// Adopts the values that the camera reports.
void AxisDrone::take_over(const Parameters& applied)
{
    read_back(applied, resolution_name, resolution_);
    read_back(applied, compression_name, compression_);
    read_back(applied, fps_name, fps_);
    read_back(applied, exposure_name, exposure_);
    read_back(applied, brightness_name, brightness_);
    read_back(applied, colour_name, colour_);
}

/// Checks several times a second even without an image, to detect a stall.
std::chrono::microseconds AxisDrone::step()
{
    if (!link_) {
        say("no camera: set url");
        return 1h;
    }
    const auto frame = link_->take();
    if (frame)
        send(*frame);
    say(link_->condition(), hive::LogLevel::warning);
    if (place_.pace == "demand" && !frame && image_.asked())
        link_->ask();
    return 250ms;
}

void AxisDrone::send(const Frame& frame)
{
    const hive::Json header{
        {"width", frame.size.width}, {"height", frame.size.height}, {"index", frame.index}, {"source", opened_->url}};
    const std::function<hive::Body()> body = [&] {
        return hive::Body(std::as_bytes(std::span(*frame.jpeg)), frame.jpeg);
    };
    image_.emit_captured(frame.captured, place_.pace == "demand", header, body, "image/jpeg");
}

void AxisDrone::say(const std::string& condition, hive::LogLevel level)
{
    if (condition == condition_)
        return;
    condition_ = condition;
    drone_.condition(condition, hive::Reason::none, level);
}

}  // namespace axis
