// The gesture drone receives silhouettes or images, and publishes hands and their fingers.
#include "hand_search.hpp"

#include <finder_drone.hpp>

#include <cmath>
#include <cstdio>

namespace {

using gesture::Hand;

hive::Json to_json(const cv::Point& point) { return {{"x", point.x}, {"y", point.y}}; }

hive::Json to_json(const Hand& hand)
{
    const auto tenths = [](double value) { return std::round(value * 10) / 10; };
    hive::Json tips = hive::Json::array();
    for (const cv::Point& tip : hand.tips)
        tips.push_back(to_json(tip));
    hive::Json json{{"x", hand.box.x},
                    {"y", hand.box.y},
                    {"w", hand.box.width},
                    {"h", hand.box.height},
                    {"palm", {{"x", hand.palm.x}, {"y", hand.palm.y}, {"radius", tenths(hand.radius)}}},
                    {"fingers", tips.size()},
                    {"pose", gesture::pose(hand)}};
    json["tips"] = std::move(tips);
    if (hand.angle)
        json["angle"] = tenths(*hand.angle);
    return json;
}

/// "x,y,w,h"; empty: no region. @throws hive::Error
cv::Rect region_from(const std::string& text)
{
    if (text.empty())
        return {};
    cv::Rect region;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%d,%d,%d,%d%c", &region.x, &region.y, &region.width, &region.height, &rest) != 4
        || region.x < 0 || region.y < 0 || region.width < 1 || region.height < 1)
        throw hive::Error(hive::Errc::refused, "region is x,y,w,h in px, as in 300,120,40,40, but not " + text);
    return region;
}

/// The parameters, and the two methods: reading the whole silhouette, and searching for skin.
class Reader {
public:
    void declare(hive::Drone& drone)
    {
        drone.parameter("silhouette", from_, hive::one_of({"auto", "mask", "skin"}),
                        "auto: grey images are masks, others are searched for hands; mask: every image is a mask; "
                        "skin: all skin-coloured pixels form one silhouette");
        drone.parameter("level", silhouette_.level, hive::between(1, 255),
                        "masks: minimum grey level of the silhouette");
        drone.parameter("max_hands", finder_.max_hands, hive::between(1, 8),
                        "maximum number of hands, largest or best first");
        drone.parameter("min_area", finder_.min_area, hive::between(0, 100).in("%"),
                        "minimum share of the image of a silhouette");
        drone.parameter("smooth", finder_.smooth, hive::between(0, 31).in("px"),
                        "smooth away narrower specks, hairs and gaps of silhouettes");
        declare_search(drone);
        declare_skin(drone);
    }

    /// Loads the detector for the parameters; if that fails, throws the reason and keeps the old one.
    void apply()
    {
        const cv::Rect region = region_from(region_);
        if (cascade_ != loaded_)
            search_.load_faces(cascade_);
        loaded_ = cascade_;
        search_.region = region;
        search_.range = silhouette_.skin;
        search_.max_hands = finder_.max_hands;
        silhouette_.from = from_ == "auto" ? "mask" : from_;
    }

    std::vector<Hand> find(const cv::Mat& image)
    {
        if (from_ == "auto" && image.channels() == 3)
            return search_.find(image);
        return finder_.find(silhouette_.of(image));
    }

    static hive::Json header(const std::vector<Hand>& found, const cv::Mat& image)
    {
        hive::Json list = hive::Json::array();
        for (const Hand& hand : found)
            list.push_back(to_json(hand));
        return {{"hands", std::move(list)}, {"width", image.cols}, {"height", image.rows}};
    }

    static void draw(cv::Mat& canvas, const std::vector<Hand>& found) { gesture::draw(canvas, found); }

private:
    void declare_search(hive::Drone& drone)
    {
        drone.parameter("region", region_, hive::anything(),
                        "search: a region showing skin, x,y,w,h in px; empty: look for a face");
        drone.parameter("tolerance", search_.tolerance, hive::between(0.5, 10),
                        "search: maximum distance from that skin colour, in standard deviations");
        drone.parameter("cascade", cascade_, hive::anything().by_operator(),
                        "search: face cascade file; empty: do not look for faces");
    }

    void declare_skin(hive::Drone& drone)
    {
        const auto byte = hive::between(0, 255);
        gesture::SkinRange& skin = silhouette_.skin;
        drone.parameter("y_min", skin.y_min, byte, "skin in YCrCb, without a face or region: minimum brightness");
        drone.parameter("y_max", skin.y_max, byte, "skin: maximum brightness");
        drone.parameter("cr_min", skin.cr_min, byte, "skin: minimum Cr");
        drone.parameter("cr_max", skin.cr_max, byte, "skin: maximum Cr");
        drone.parameter("cb_min", skin.cb_min, byte, "skin: minimum Cb");
        drone.parameter("cb_max", skin.cb_max, byte, "skin: maximum Cb");
    }

    std::string from_ = "auto", region_, loaded_,
                cascade_ = "/usr/share/opencv4/haarcascades/haarcascade_frontalface_alt2.xml";
    gesture::Silhouette silhouette_;
    gesture::GestureFinder finder_;
    gesture::HandSearch search_;
};

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"gesture", "Finds hands in images and counts their fingers."},
                           [](hive::Drone& drone) {
                               finder_drone::run(drone, Reader(),
                                                 {.input = "mask",
                                                  .input_help = "masks, or images to search for hands",
                                                  .output = "gesture",
                                                  .output_help = "the hands, in the header; no body",
                                                  .annotated_help = "the image with the hands marked"});
                           });
}
