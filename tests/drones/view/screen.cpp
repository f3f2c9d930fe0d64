// The window and the page on a screen, if Xvfb and chromium are installed.
#include "free_port.hpp"
#include "http.hpp"

#include <swarm.hpp>

#include <doctest/doctest.h>
#include <possible.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <set>

using namespace hive::test;

namespace {

bool installed(const std::string& program)
{
    if (sanitized())
        return possible(missing_if_sanitized());  // Qt leaks at its end
    return possible(std::filesystem::exists("/usr/bin/" + program) ? "" : program);
}

/// A display of its own.
class TestScreen {
public:
    explicit TestScreen(const Swarm& swarm)
        : server_({"/usr/bin/Xvfb", "-displayfd", "1", "-screen", "0", "800x600x24", "-nolisten", "tcp"}, {},
                  swarm.home() / "number", swarm.home() / "xvfb.log")
    {
        REQUIRE(eventually([&] { return text_of(swarm.home() / "number").ends_with('\n'); }, Milliseconds(20'000)));
        const std::string number = text_of(swarm.home() / "number");
        name = ":" + number.substr(0, number.size() - 1);
        XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });  // windows may go while they are looked at
        display_ = XOpenDisplay(name.c_str());
        REQUIRE(display_);
    }
    ~TestScreen() { XCloseDisplay(display_); }

    /// The window that is titled so and can be seen; 0: none.
    Window find(const std::string& title) const { return find(title, DefaultRootWindow(display_)); }
    /// Its size and how much its pixels differ.
    std::pair<cv::Size, double> look(Window window) const
    {
        XWindowAttributes shape{};
        if (!XGetWindowAttributes(display_, window, &shape))
            return {};
        XImage* image = XGetImage(display_, window, 0, 0, static_cast<unsigned>(shape.width),
                                  static_cast<unsigned>(shape.height), AllPlanes, ZPixmap);
        if (!image)
            return {};
        cv::Scalar mean, deviation;
        cv::meanStdDev(
            cv::Mat(image->height, image->width, CV_8UC4, image->data, static_cast<std::size_t>(image->bytes_per_line)),
            mean, deviation);
        XDestroyImage(image);
        return {{shape.width, shape.height}, deviation[0]};
    }
    void press_q(Window window) const
    {
        XEvent event{};
        event.xkey = {KeyPress, 0, True, display_, window, DefaultRootWindow(display_),      0,   CurrentTime,
                      1,        1, 1,    1,        0,      XKeysymToKeycode(display_, XK_q), True};
        XSendEvent(display_, window, True, KeyPressMask, &event);
        event.type = KeyRelease;
        XSendEvent(display_, window, True, KeyReleaseMask, &event);
        XFlush(display_);
    }
    void close(Window window) const
    {
        XEvent event{};
        event.xclient.type = ClientMessage;
        event.xclient.window = window;
        event.xclient.message_type = XInternAtom(display_, "WM_PROTOCOLS", False);
        event.xclient.format = 32;
        event.xclient.data.l[0] = static_cast<long>(XInternAtom(display_, "WM_DELETE_WINDOW", False));
        XSendEvent(display_, window, False, NoEventMask, &event);
        XFlush(display_);
    }

    std::string name;

private:
    Window find(const std::string& title, Window above) const
    {
        char* text = nullptr;
        XWindowAttributes shape{};
        const bool here = XFetchName(display_, above, &text) && text && title == text
                          && XGetWindowAttributes(display_, above, &shape) && shape.map_state == IsViewable;
        if (text)
            XFree(text);
        if (here)
            return above;
        Window root = 0, parent = 0, *below = nullptr, found = 0;
        unsigned count = 0;
        XQueryTree(display_, above, &root, &parent, &below, &count);
        for (unsigned i = 0; i < count && !found; ++i)
            found = find(title, below[i]);
        if (below)
            XFree(below);
        return found;
    }

    Process server_;
    Display* display_ = nullptr;
};

}  // namespace

TEST_CASE("view window: shows the image in its size, q or closing it ends the drone, and it can be hidden and shown "
          "again (needs Xvfb)")
{
    if (!installed("Xvfb"))
        return;
    const Swarm swarm;
    const TestScreen screen(swarm);
    const auto camera = swarm.drone("camera", "camera");
    auto application = swarm.application();
    const auto window = [&] { return screen.find("camera.image - Hive view"); };
    for (const auto& end :
         {std::function([&] { screen.press_q(window()); }), std::function([&] { screen.close(window()); })}) {
        auto view = swarm.drone("view", "view", {}, {}, {"DISPLAY=" + screen.name});
        application.connect({"camera", ""}, {"view", ""});
        REQUIRE(eventually([&] { return window() != 0; }, Milliseconds(20'000)));
        CHECK(eventually([&] { return screen.look(window()).first == cv::Size(640, 480); }, Milliseconds(5000)));
        CHECK(eventually([&] { return screen.look(window()).second > 5; }, Milliseconds(5000)));
        application.set("view", {{"window", "off"}});
        CHECK(eventually([&] { return window() == 0; }, Milliseconds(5000)));
        application.set("view", {{"window", "auto"}});
        REQUIRE(eventually([&] { return window() != 0; }, Milliseconds(5000)));
        end();
        CHECK(view.wait(Milliseconds(60'000)) == 0);
    }
}

TEST_CASE("view window: an image larger than the screen is scaled with its aspect ratio (needs Xvfb)")
{
    if (!installed("Xvfb"))
        return;
    const Swarm swarm;
    const TestScreen screen(swarm);
    const auto camera = swarm.drone("camera", "camera", {"width=1600", "height=900", "fps=10"});
    const auto view = swarm.drone("view", "view", {}, {}, {"DISPLAY=" + screen.name});
    swarm.application().connect({"camera", ""}, {"view", ""});
    const auto window = [&] { return screen.find("camera.image - Hive view"); };
    REQUIRE(eventually([&] { return window() != 0; }, Milliseconds(20'000)));
    // Of the 800x600 px of the screen 760x528 are for windows.
    CHECK(eventually([&] { return screen.look(window()).first == cv::Size(760, 427); }, Milliseconds(5000)));
}

TEST_CASE("view window: the text on a still image is updated (needs Xvfb)")
{
    if (!installed("Xvfb"))
        return;
    const Swarm swarm;
    const TestScreen screen(swarm);
    const auto camera = swarm.drone("camera", "camera");
    const auto view = swarm.drone("view", "view", {}, {}, {"DISPLAY=" + screen.name});
    auto application = swarm.application();
    application.connect({"camera", ""}, {"view", ""});
    const auto window = [&] { return screen.find("camera.image - Hive view"); };
    REQUIRE(eventually([&] { return window() != 0; }, Milliseconds(20'000)));
    swarm.hivectl_done({"halt", "camera"});
    std::set<double> looks;  // a few are of images that were on their way
    CHECK(eventually([&] { return looks.insert(screen.look(window()).second), looks.size() >= 6; },
                     Milliseconds(12'000)));
}

TEST_CASE("hivectl view: exits with 0 when its window is closed (needs Xvfb)")
{
    if (!installed("Xvfb"))
        return;
    const Swarm swarm;
    const TestScreen screen(swarm);
    const auto camera = swarm.drone("camera", "camera");
    Process process({"/usr/bin/env", "HIVE_HOME=" + swarm.home().string(), "DISPLAY=" + screen.name,
                     swarm.program("hivectl").string(), "view", "camera"},
                    {}, swarm.home() / "hivectl.log");
    REQUIRE(eventually([&] { return screen.find("camera.image - Hive view") != 0; }, Milliseconds(20'000)));
    screen.close(screen.find("camera.image - Hive view"));
    CHECK(process.wait(Milliseconds(60'000)) == 0);
    CHECK(swarm.application().drones() == std::vector<std::string>{"camera"});
}

TEST_CASE("view page: a browser shows the image and the numbers (needs chromium)")
{
    if (!installed("chromium"))
        return;
    const Swarm swarm;
    const int port = free_port();
    const auto camera = swarm.drone("camera", "camera");
    const auto view =
        swarm.drone("view", "view", {"http=" + std::to_string(port), "token=" + http::token}, {}, {"DISPLAY="});
    swarm.application().connect({"camera", ""}, {"view", ""});
    const auto file = (swarm.home() / "page.png").string();
    const auto finished = swarm.run({"/usr/bin/chromium", "--headless", "--no-sandbox", "--disable-gpu",
                                     "--user-data-dir=" + (swarm.home() / "profile").string(), "--hide-scrollbars",
                                     "--window-size=800,720", "--timeout=8000", "--screenshot=" + file,
                                     "http://127.0.0.1:" + std::to_string(port) + "/?token=" + http::token},
                                    Milliseconds(60'000));
    CAPTURE(finished.err);
    const cv::Mat page = cv::imread(file);
    REQUIRE(page.size() == cv::Size(800, 720));
    const cv::Scalar middle = cv::mean(page.rowRange(250, 450));
    CHECK(middle[2] > middle[0] + 20);                     // bricks are red, the page around them is not
    const cv::Mat light = page(cv::Rect(14, 12, 16, 22));  // green: images come
    cv::Mat green;
    cv::inRange(light, cv::Scalar(90, 180, 30), cv::Scalar(170, 255, 100), green);
    CHECK(cv::countNonZero(green) > 20);
}
