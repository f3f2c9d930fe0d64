// Ties the window and the server to the drone's parameters and input.
#pragma once

#include "exchange.hpp"
#include "server.hpp"
#include "window.hpp"

#include <hive/drone.hpp>

#include <chrono>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace view {

/// On the user thread.
class ViewDrone {
public:
    explicit ViewDrone(hive::Drone& drone);
    void run() { drone_.run(); }

private:
    using Clock = std::chrono::steady_clock;

    void declare();
    void apply();
    void serve();
    [[nodiscard]] std::string problem() const;
    [[nodiscard]] bool wants_window() const { return window_ == "on" || (window_ == "auto" && display_); }
    void take(const hive::Event& event);
    [[nodiscard]] Image::Content content_of(const hive::Event& event) const;
    void show();
    void hold(const hive::Event& event);
    std::chrono::microseconds step();

    hive::Drone& drone_;
    int http_ = 0, quality_ = 80, hold_ms_ = 16;
    std::string bind_ = "127.0.0.1", token_, window_ = "auto";
    bool overlay_ = true, display_ = false;

    const std::string drawn_token_ = hive::http::Pass::draw_token();
    Exchange exchange_;
    Rate rate_;
    std::tuple<std::string, int, std::string> served_;  ///< address, port and token; port 0: none
    std::unique_ptr<Server> server_;
    std::unique_ptr<Window> windows_;  ///< created for the first image to show
    /// Unacknowledged images, so that their senders wait, and until when.
    std::vector<std::pair<Clock::time_point, hive::Ticket>> held_;
};

}  // namespace view
