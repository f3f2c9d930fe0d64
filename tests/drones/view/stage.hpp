// A server of the view drone with images to give.
#pragma once

#include "http.hpp"

#include "server.hpp"

#include <opencv2/core.hpp>

#include <atomic>
#include <functional>
#include <memory>

namespace stage {

/// A server with images to give; counts how many were decoded.
class Stage {
public:
    explicit Stage(view::Server::Settings settings = {})
        : exchange_(view::Image::of_notice("no image yet")), server_(with_token(std::move(settings)), exchange_)
    {
    }
    /// Noise of `width` pixels, so that it is distinguishable and large when encoded.
    void put(int width, int height = 30)
    {
        const auto pixels = [this, width, height] {
            ++decoded;
            cv::Mat noise(height, width, CV_8UC3);
            cv::randu(noise, 0, 255);
            return noise;
        };
        put_pixels(pixels);
    }
    void put_pixels(std::function<cv::Mat()> pixels)
    {
        exchange_.put(std::make_shared<const view::Image>(
            view::Origin{}, view::Image::Content{std::move(pixels), nullptr}, view::Image::Look{.overlay = false}));
        server_.wake();
    }
    [[nodiscard]] int port() const { return server_.port(); }
    [[nodiscard]] int browsers() const { return http::get(port(), "/status.json").json().at("browsers"); }

    std::atomic<int> decoded{0};

private:
    static view::Server::Settings with_token(view::Server::Settings settings)
    {
        settings.token = http::token;
        return settings;
    }
    view::Exchange exchange_;
    view::Server server_;
};

/// The width of the next image of a stream; 0: none.
inline int next_width(http::Client& client)
{
    const auto jpeg = client.next_image();
    return jpeg ? http::decoded(*jpeg).cols : 0;
}

inline constexpr int notice_width = 640;

}  // namespace stage
