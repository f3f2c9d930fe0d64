// What is made of the answers of a camera's driver; here the driver is made up.
#include "words/video_device.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <linux/videodev2.h>

using hivectl::VideoMode;

namespace {

/// One camera with compressed images of two sizes, and raw ones of any size.
class Driver {
public:
    unsigned capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_DEVICE_CAPS;
    unsigned own = V4L2_CAP_VIDEO_CAPTURE;
    bool tells_sizes = true;
    bool endless = false;

    bool operator()(unsigned long request, void* about) const
    {
        switch (request) {
        case VIDIOC_QUERYCAP: return describe(*static_cast<v4l2_capability*>(about));
        case VIDIOC_ENUM_FMT: return format(*static_cast<v4l2_fmtdesc*>(about));
        case VIDIOC_ENUM_FRAMESIZES: return tells_sizes && size(*static_cast<v4l2_frmsizeenum*>(about));
        case VIDIOC_ENUM_FRAMEINTERVALS: return interval(*static_cast<v4l2_frmivalenum*>(about));
        default: return false;
        }
    }

private:
    bool describe(v4l2_capability& about) const
    {
        std::memset(about.card, 'c', sizeof about.card);  // no end
        std::strcpy(reinterpret_cast<char*>(about.driver), "uvcvideo");
        about.capabilities = capabilities;
        about.device_caps = own;
        return true;
    }
    bool format(v4l2_fmtdesc& one) const
    {
        one.pixelformat = one.index == 1 ? V4L2_PIX_FMT_YUYV : V4L2_PIX_FMT_MJPEG;
        return one.type == V4L2_BUF_TYPE_VIDEO_CAPTURE && (endless || one.index < 2);
    }
    bool size(v4l2_frmsizeenum& one) const
    {
        if (one.pixel_format == V4L2_PIX_FMT_YUYV) {
            one.type = V4L2_FRMSIZE_TYPE_STEPWISE;
            one.stepwise = {160, 1920, 16, 120, 1080, 8};
            return true;
        }
        one.type = V4L2_FRMSIZE_TYPE_DISCRETE;
        one.discrete = one.index == 0 ? v4l2_frmsize_discrete{1280, 720} : v4l2_frmsize_discrete{640, 480};
        return endless || one.index < 2;
    }
    bool interval(v4l2_frmivalenum& one) const
    {
        if (one.pixel_format == V4L2_PIX_FMT_YUYV) {
            one.type = V4L2_FRMIVAL_TYPE_CONTINUOUS;
            one.stepwise = {{1, 60}, {1, 5}, {1, 1}};
            return true;
        }
        one.type = V4L2_FRMIVAL_TYPE_DISCRETE;
        constexpr v4l2_fract intervals[] = {{1, 30}, {2, 15}, {0, 1}};
        one.discrete = intervals[one.index % 3];
        return endless || one.index < 3;
    }
};

}  // namespace

TEST_CASE("video device: formats, sizes and rates are those that the driver enumerates")
{
    const auto device = hivectl::video_device(Driver());
    REQUIRE(device);
    CHECK(device->name == std::string(32, 'c'));
    CHECK(device->driver == "uvcvideo");
    CHECK(device->modes
          == std::vector<VideoMode>{{"MJPG", "1280x720", {30, 7.5}},
                                    {"MJPG", "640x480", {30, 7.5}},
                                    {"YUYV", "160x120 to 1920x1080", {5, 60}}});
    CHECK(hivectl::rates_text(device->modes[0].rates) == "30 7.5");
}

TEST_CASE("video device: what takes no images is none, though its camera has another that does")
{
    Driver driver;
    driver.own = V4L2_CAP_META_CAPTURE;
    CHECK_FALSE(hivectl::video_device(driver));
    driver.capabilities = V4L2_CAP_VIDEO_CAPTURE;  // an old driver, which tells of all together
    CHECK(hivectl::video_device(driver));
    CHECK_FALSE(hivectl::video_device([](unsigned long, void*) { return false; }));
}

TEST_CASE(
    "video device: a driver that tells no sizes has its formats listed, one that enumerates without end is cut off")
{
    Driver driver;
    driver.tells_sizes = false;
    CHECK(hivectl::video_device(driver)->modes == std::vector<VideoMode>{{"MJPG", "", {}}, {"YUYV", "", {}}});
    driver.tells_sizes = driver.endless = true;
    CHECK(hivectl::video_device(driver)->modes.size() < 10'000);
}
