// The annotate drone receives images and the results of other drones, and publishes the images with the results drawn
// in.
#include "drawing.hpp"
#include "marks.hpp"

#include <hive/drone.hpp>
#include <hive/vision/encoder.hpp>
#include <hive/vision/image.hpp>
#include <hive/vision/loans.hpp>
#include <media_fields.hpp>

#include <opencv2/core/utility.hpp>

namespace {

void check_image(const hive::Event& event)
{
    static_cast<void>(hive::vision::size_of(event.body, event.type, {}, event.header));
}

annotate::Drawing::Uncertain uncertain_of(const std::string& text)
{
    using enum annotate::Drawing::Uncertain;
    return text == "dashed" ? dashed : text == "hidden" ? hidden : solid;
}

hive::Json header_of(const hive::Event& image, const hive::Event& marks, const hive::vision::PlainForm& form)
{
    hive::Json header = form.header;
    media_fields::pass_on(image.header, header);
    header["marks"] = marks.header;
    header["apart_ms"] = static_cast<double>(image.identity.captured_us - marks.identity.captured_us) / 1000;
    return header;
}

void annotate_drone(hive::Drone& drone)
{
    annotate::Drawing drawing;
    std::string match = "exact";
    int tolerance = 50;
    std::string uncertain = "dashed";
    drone.parameter("match", match, hive::one_of({"exact", "nearest"}),
                    "exact: marks of the same image; nearest: each set of marks on the image nearest in time");
    drone.parameter("tolerance", tolerance, hive::between(0, 10'000).in("ms"),
                    "with match=nearest: maximum time difference");
    drone.parameter("thickness", drawing.thickness, hive::between(0, 20).in("px"),
                    "width of the lines; 0: by the size of the image");
    drone.parameter("labels", drawing.labels, hive::anything(), "write labels next to the marks");
    drone.parameter("uncertain", uncertain, hive::one_of({"dashed", "hidden", "solid"}),
                    "how to draw tracks that are unconfirmed or currently not seen");
    const hive::Output annotated =
        drone.output("annotated", hive::vision::image_types, "the image with its marks", hive::vision::encoder());
    hive::vision::LoanAllocator loans([&](std::size_t bytes) { return annotated.loan(bytes); });
    const auto matching =
        drone.on_matched({{"image", hive::vision::image_types, "images to draw on", check_image},
                          {"marks", "application/json", "results to draw, in the header"}},
                         hive::Match::exact(), [&](const std::vector<hive::Event>& set) {
                             const hive::Event& image = set[0];
                             const auto form = hive::vision::plain_form(
                                 hive::vision::size_of(image.body, image.type, {}, image.header), 3);
                             annotated.emit(
                                 header_of(image, set[1], form),
                                 [&] {
                                     cv::Mat result = loans.image();  // drawn in the memory that is emitted
                                     drawing.draw(hive::vision::view(image), annotate::marks_in(set[1].header), result);
                                     return form.body(result);
                                 },
                                 form.type);
                         });
    drone.on_start([] { cv::setNumThreads(1); });  // one drone, one core
    drone.on_change([&] {
        drawing.uncertain = uncertain_of(uncertain);
        matching.rule(match == "exact" ? hive::Match::exact()
                                       : hive::Match::within(std::chrono::milliseconds(tolerance)));
    });
    drone.run();
}

}  // namespace

int main(int argc, char** argv)
{
    return hive::run_drone(argc, argv, {"annotate", "Draws the results of other drones onto images."}, annotate_drone);
}
