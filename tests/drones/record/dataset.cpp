// Boxes of events as CSV, COCO and YOLO.
#include <hive/error.hpp>
#include <hive/recording/dataset.hpp>
#include <hive/recording/field_table.hpp>

#include <doctest/doctest.h>

using hive::Json;
using namespace hive::recording;

namespace {

hive::Event event(const Json& header, std::int64_t sequence = 12)
{
    hive::Event one;
    one.identity.source = "camera";
    one.identity.epoch = 5;
    one.identity.sequence = sequence;
    one.identity.captured_us = 77;
    one.sender = "face-1";
    one.kind = "face";
    one.output = "faces";
    one.header = header;
    return one;
}

Json header(const Json& box, const std::string& file = "")
{
    Json result{{"objects", Json::array({box})}, {"width", 200}, {"height", 100}};
    if (!file.empty())
        result["file"] = file;
    return result;
}

const Json dog{{"x", 50}, {"y", 20}, {"w", 100}, {"h", 40}, {"class", "dog"}, {"score", 0.5}};

std::string refusal(const std::function<void()>& action)
{
    try {
        action();
        return "";
    } catch (const hive::Error& error) {
        CHECK(error.code() == hive::Errc::refused);
        return error.what();
    }
}

}  // namespace

TEST_CASE("dataset: names come from the image file, the video and the capture, or the source; none leads elsewhere")
{
    const auto name = [](const std::string& file) { return detections_in(event(header(dog, file))).name; };
    CHECK(name("/data/street/0001.PNG") == "0001.PNG");
    CHECK(name("/data/street.avi") == "street_00000012.jpg");
    CHECK(name("") == "camera_00000012.jpg");
    CHECK(name("/data/.hidden.jpg") == "_.hidden.jpg");
    CHECK(name("/data/a b\n;.jpg") == "a_b__.jpg");
    CHECK(name("/data/..") == "_.._00000012.jpg");
}

TEST_CASE("dataset: the category is the class of the box, or else the kind of the drone")
{
    Json face = dog;
    face.erase("class");
    CHECK(detections_in(event(header(dog))).detections.at(0).category == "dog");
    CHECK(detections_in(event(header(face))).detections.at(0).category == "face");
}

TEST_CASE("dataset: an event without boxes is refused, and for a dataset one without the size of its image")
{
    CHECK(refusal([] {
              detections_in(event({{"gesture", "fist"}}));
          }).find("face-1.faces has no boxes")
          != std::string::npos);
    const auto image = detections_in(event({{"faces", Json::array({dog})}}));
    Dataset dataset;
    CHECK(refusal([&] { dataset.add(image); }).find("camera 12: the header has no width and height")
          != std::string::npos);
    CHECK(dataset.size() == 0);
    CHECK(csv_rows(image).starts_with("camera_00000012.jpg,,,camera,5,12,77,,"));
}

TEST_CASE("dataset: CSV has as many fields in each row as in the heading, and quotes what has to be")
{
    Json odd = dog;
    odd["class"] = "a \"b\",\nc";
    CHECK(csv_heading()
          == "image,width,height,source,epoch,seq,time_us,media_time_us,sender,output,category,id,score,x,y,w,h,"
             "confirmed,missing\n");
    CHECK(csv_rows(detections_in(event(header(dog))))
          == "camera_00000012.jpg,200,100,camera,5,12,77,,face-1,faces,dog,,0.5,50.0,20.0,100.0,40.0,,\n");
    CHECK(csv_rows(detections_in(event(header(odd)))).find(",\"a \"\"b\"\", c\",") != std::string::npos);
}

TEST_CASE("dataset: COCO has images, categories and annotations whose ids agree, and results that refer to them")
{
    Json person = dog;
    person["class"] = "person";
    person.erase("score");
    Dataset dataset;
    dataset.add(detections_in(event(header(dog), 1)));
    dataset.add(detections_in(event({{"objects", Json::array()}, {"width", 200}, {"height", 100}}, 2)));
    dataset.add(detections_in(event(header(person), 3)));
    CHECK(dataset.coco_results()
          == Json::parse(R"([{"image_id":1,"category_id":1,"bbox":[50.0,20.0,100.0,40.0],"score":0.5},
                             {"image_id":3,"category_id":2,"bbox":[50.0,20.0,100.0,40.0],"score":1.0}])"));
    const Json coco = dataset.coco();
    CHECK(coco.at("images").size() == 3);
    CHECK(coco.at("images")[2]
          == Json::parse(R"({"id":3,"file_name":"camera_00000003.jpg","width":200,"height":100})"));
    CHECK(coco.at("categories") == Json::parse(R"([{"id":1,"name":"dog"},{"id":2,"name":"person"}])"));
    CHECK(coco.at("annotations")[1].at("id") == 2);
    CHECK(coco.at("annotations")[1].at("area") == 4000);
    CHECK(coco.at("annotations")[1].at("iscrowd") == 0);
}

TEST_CASE("dataset: YOLO has one file for each image, centres as shares, and boxes cut at the border")
{
    Json cut = dog, outside = dog;
    cut["x"] = -50;
    outside["x"] = 300;
    Dataset dataset;
    dataset.add(detections_in(
        event({{"objects", Json::array({dog, cut, outside})}, {"width", 200}, {"height", 100}, {"file", "a/7.png"}})));
    dataset.add(detections_in(event({{"objects", Json::array()}, {"width", 9}, {"height", 9}}, 13)));
    const auto files = dataset.yolo();
    REQUIRE(files.size() == 2);
    CHECK(files.at("7.txt") == "0 0.500000 0.400000 0.500000 0.400000\n0 0.125000 0.400000 0.250000 0.400000\n");
    CHECK(files.at("camera_00000013.txt").empty());
    dataset.add(detections_in(event(header(dog, "b/7.jpg"), 14)));
    CHECK(refusal([&] { static_cast<void>(dataset.yolo()); }).find("7.txt") != std::string::npos);
}

TEST_CASE("dataset: predicted boxes and unconfirmed tracks are rows, but no annotations")
{
    for (const Json& more : {Json{{"missing", 2}}, Json{{"confirmed", false}}}) {
        Json track = dog;
        track.update(more);
        const auto image = detections_in(event(header(track)));
        CHECK(csv_rows(image).find(",dog,") != std::string::npos);
        Dataset dataset;
        dataset.add(image);
        CHECK(dataset.coco_results().empty());
    }
}

TEST_CASE("dataset: two drones on one capture are one image; another capture of that name is left out")
{
    Dataset dataset;
    CHECK(dataset.add(detections_in(event(header(dog, "1.jpg")))) == Dataset::Added::fresh);
    CHECK(dataset.add(detections_in(event(header(dog, "1.jpg")))) == Dataset::Added::again);
    CHECK(dataset.add(detections_in(event(header(dog, "1.jpg"), 13))) == Dataset::Added::other_capture);
    CHECK(dataset.size() == 1);
    CHECK(dataset.coco_results().size() == 2);
}

TEST_CASE("fields: a column for each that is named, by keys, names and places; what an event has not is empty")
{
    const Json counts = Json::parse(R"({"zones":[{"name":"door","occupancy":2},{"name":"a.b","occupancy":3}],
                                        "note":"a, \"b\"","none":null,"corners":[[0,1],[2,3]]})");
    FieldTable table(
        "zones.door.occupancy,zones.a.b.occupancy,zones.1.name,note,none,corners,corners.1.0,zones.9.name");
    CHECK(table.heading()
          == "source,epoch,seq,time_us,sender,output,zones.door.occupancy,zones.a.b.occupancy,zones.1.name,note,none,"
             "corners,corners.1.0,zones.9.name\n");
    CHECK(table.row(event(counts)) == "camera,5,12,77,face-1,faces,2,3,a.b,\"a, \"\"b\"\"\",,\"[[0,1],[2,3]]\",2,\n");
    CHECK(table.missing() == std::vector<std::string>{"zones.9.name"});
    CHECK(single_fields(Json::parse(R"({"a":{"b":1},"zones":[{"name":"door","in":1}],"points":[[0,1]]})"))
          == std::vector<std::string>{"a.b", "points", "zones.door.in", "zones.door.name"});
    CHECK_THROWS_WITH_AS(FieldTable("a,,b"), "\"a,,b\" has an empty field", hive::Error);
    CHECK_THROWS_WITH_AS(FieldTable("a,b,a"), "the field a is named twice", hive::Error);
}
