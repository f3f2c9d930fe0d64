// Connects events to the exchange, and parameters to the window and the server.
#include "view_drone.hpp"

#include "display.hpp"

#include <hive/http/host.hpp>
#include <hive/vision/image.hpp>

#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <csignal>
#include <span>
#include <stdexcept>
#include <unistd.h>

namespace view {
namespace {

using namespace std::chrono_literals;

constexpr const char* no_display =
    "no display for a window (DISPLAY); use a browser: http=PORT, or hivectl view --http PORT";

Origin origin_of(const hive::Event& event, cv::Size size, double rate)
{
    Origin origin{event.sender + "." + event.output, event.identity.source, event.identity.sequence, size, {}, rate};
    if (event.identity.captured_us > 0)
        origin.captured = std::chrono::system_clock::time_point(std::chrono::microseconds(event.identity.captured_us));
    return origin;
}

}  // namespace

ViewDrone::ViewDrone(hive::Drone& drone) : drone_(drone), exchange_(Image::of_notice("no image yet"))
{
    declare();
    drone_.on_start([] { cv::setNumThreads(1); });  // one drone, one core
    drone_.on_change([this] { apply(); });
    drone_.on_event(
        "image", hive::vision::image_types, [this](const hive::Event& event) { take(event); }, "the images to show");
    drone_.main([this] { return step(); });
}

void ViewDrone::declare()
{
    drone_.parameter("http", http_, hive::between(0, 65535).by_operator(), "HTTP port for browsers; 0: none");
    drone_.parameter("bind", bind_, hive::anything().by_operator(),
                     "address of the page; 0.0.0.0: every address of this machine");
    drone_.parameter("token", token_, hive::anything().by_operator(),
                     "the token that browsers must send, as in http://127.0.0.1:8080/?token=TOKEN; empty: a random "
                     "one, printed to the log");
    drone_.parameter("window", window_, hive::one_of({"auto", "off", "on"}), "auto: if there is a display");
    drone_.parameter("overlay", overlay_, hive::anything(),
                     "draw names, rate and age on images, except on the page, which shows them separately");
    drone_.parameter("quality", quality_, hive::between(1, 100), "quality of the JPEG for browsers");
    drone_.parameter("hold", hold_ms_, hive::between(0, 60'000).in("ms"),
                     "minimum time that an image is shown before the next request");
}

void ViewDrone::apply()
{
    display_ = window_ != "off" && has_display();
    if (window_ == "on" && !display_)
        throw hive::Error(hive::Errc::refused, no_display);
    serve();
    if (windows_)
        windows_->visible(wants_window());
    held_.clear();
    drone_.condition(problem());
}

/// The old server ends first: both may use the same port. If the new one cannot listen, the old parameters are
/// restored.
void ViewDrone::serve()
{
    const std::string& token = token_.empty() ? drawn_token_ : token_;
    const std::tuple wanted(bind_, http_, token);
    if (wanted == served_)
        return;
    server_.reset();
    served_ = {};
    try {
        if (http_ != 0) {
            server_ =
                std::make_unique<Server>(Server::Settings{.bind = bind_, .port = http_, .token = token}, exchange_);
            drone_.log("serving browsers on " + hive::http::url_of(bind_, http_)
                       + (token_.empty() ? "?token=" + drawn_token_ : ""));
        }
    } catch (const std::runtime_error& error) {
        throw hive::Error(hive::Errc::refused, error.what());
    }
    served_ = wanted;
}

std::string ViewDrone::problem() const
{
    if (server_ || wants_window())
        return {};
    return window_ == "off" ? "no viewer possible: window is off, http is 0" : no_display;
}

void ViewDrone::take(const hive::Event& event)
{
    const cv::Size size =
        hive::vision::size_of(event.body, event.type, {}, event.header);  // throws for anything that is not an image
    exchange_.put(std::make_shared<Image>(origin_of(event, size, rate_.count(Clock::now())), content_of(event),
                                          Image::Look{overlay_, quality_}));
    show();
    hold(event);
}

/// Decodes only when a viewer needs the image, on the thread of the window or of the encoder.
Image::Content ViewDrone::content_of(const hive::Event& event) const
{
    hive::Event image = event;
    image.ticket = {};  // acknowledged now: viewing is not processing
    Image::Content content{[this, image] {
                               try {
                                   return hive::vision::view(image);
                               } catch (const hive::Error& error) {
                                   drone_.report(error.code(), error.what());
                                   throw;
                               }
                           },
                           nullptr};
    if (event.type == "image/jpeg" && (!overlay_ || server_)) {
        const std::span bytes(reinterpret_cast<const unsigned char*>(event.body.data()), event.body.size());
        content.jpeg = std::make_shared<const std::vector<unsigned char>>(bytes.begin(), bytes.end());
    }
    return content;
}

void ViewDrone::show()
{
    if (server_)
        server_->wake();
    if (!windows_ && wants_window())
        windows_ = std::make_unique<Window>(
            exchange_, [] { ::kill(::getpid(), SIGTERM); });  // as if the drone had been stopped by a command
    else if (windows_)
        windows_->wake();
}

void ViewDrone::hold(const hive::Event& event)
{
    if (hold_ms_ == 0)
        return;
    held_.emplace_back(event.received + std::chrono::milliseconds(hold_ms_), event.ticket);
    drone_.wake();
}

/// Releases images that were shown long enough; returns the time of the next release.
std::chrono::microseconds ViewDrone::step()
{
    const auto now = Clock::now();
    std::erase_if(held_, [&](const auto& held) { return held.first <= now; });
    const auto next = std::ranges::min_element(held_, {}, [](const auto& held) { return held.first; });
    return next == held_.end() ? 1h : std::chrono::ceil<std::chrono::microseconds>(next->first - now);
}

}  // namespace view
