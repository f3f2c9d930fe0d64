// Shows OpenCV's window, and polls it for input 100 times per second.
#include "window.hpp"

#include "display.hpp"

#include <opencv2/highgui.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace view {
namespace {

constexpr const char* name = "hive view";
constexpr auto look_every = std::chrono::milliseconds(10);

}  // namespace

Window::Window(const Exchange& exchange, std::function<void()> closed)
    : exchange_(exchange), thread_([this, closed = std::move(closed)] { run(closed); })
{
}

Window::~Window()
{
    ending_ = true;
    wake();
    thread_.join();
}

void Window::visible(bool yes)
{
    visible_ = yes;
    wake();
}

void Window::wake()
{
    ++wakes_;
    wakes_.notify_one();
}

void Window::run(const std::function<void()>& closed)
{
    while (!ending_) {
        const unsigned wakes = wakes_;
        const auto newest = exchange_.newest();
        if (visible_ && newest.version > version_)
            show(newest);
        if (open_ && !visible_) {
            cv::destroyWindow(name);
            cv::waitKey(1);  // the toolkit closes the window here
            open_ = false;
        }
        if (!open_ && !ending_)
            wakes_.wait(wakes);
        else if (open_ && ended_by_user())
            return closed();
    }
    if (open_)
        cv::destroyAllWindows();
}

void Window::show(const Exchange::Newest& newest)
{
    if (!open_) {
        cv::namedWindow(name, cv::WINDOW_AUTOSIZE | cv::WINDOW_GUI_NORMAL);
        room_ = room_for_window();  // again for each image, because screens are added and removed
    }
    cv::imshow(name, fitted(newest.image->shown(), room_));
    if (const auto& sender = newest.image->origin().sender; sender != title_ || !open_) {
        cv::setWindowTitle(name, sender + " - Hive view");
        title_ = sender;
    }
    version_ = newest.version;
    open_ = true;
}

cv::Mat Window::fitted(const cv::Mat& image, const std::optional<cv::Size>& room)
{
    if (!room || (image.cols <= room->width && image.rows <= room->height))
        return image;
    const double scale =
        std::min(static_cast<double>(room->width) / image.cols, static_cast<double>(room->height) / image.rows);
    cv::Mat smaller;
    cv::resize(image, smaller,
               {std::max(1, static_cast<int>(scale * image.cols)), std::max(1, static_cast<int>(scale * image.rows))},
               0, 0, cv::INTER_AREA);
    return smaller;
}

bool Window::ended_by_user()
{
    const int key = cv::waitKey(static_cast<int>(look_every.count()));
    return key == 'q' || key == 27 || cv::getWindowProperty(name, cv::WND_PROP_VISIBLE) < 1;
}

}  // namespace view
