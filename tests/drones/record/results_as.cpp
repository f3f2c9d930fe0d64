// hivectl results --as: files that other tools read, of a real face drone.
#include "swarm.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

using namespace hive::test;
using hive::Json;

namespace {

std::string written_in(const std::filesystem::path& path)
{
    std::stringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("results --as: csv is printed, coco and yolo fill a folder, and their boxes agree")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"noise=0", "fps=10"}), face = swarm.drone("face", "face");
    swarm.hivectl_done({"connect", "camera", "face"});
    const auto csv = swarm.hivectl_done({"results", "face.faces", "-n", "3", "--as", "csv"});
    CHECK(csv.starts_with("image,width,height,source,"));
    CHECK(says(csv, ",face,faces,face,"));
    const auto coco = swarm.home() / "coco", yolo = swarm.home() / "yolo";
    const auto summary = swarm.hivectl_done({"results", "face.faces", "-n", "3", "--as", "coco", "-o", coco.string()});
    const Json dataset = Json::parse(written_in(coco / "dataset.json")),
               results = Json::parse(written_in(coco / "results.json"));
    CHECK(dataset.at("images").size() == 3);
    CHECK(says(summary, "3 images, " + std::to_string(results.size()) + " boxes, 1 category"));
    REQUIRE_FALSE(results.empty());
    CHECK(results.size() == dataset.at("annotations").size());
    CHECK(results.at(0).at("bbox") == dataset.at("annotations").at(0).at("bbox"));
    const auto one = (swarm.home() / "one").string();
    CHECK(says(swarm.hivectl_done({"results", "face.faces", "-n", "1", "--as", "coco", "-o", one}), ": 1 image, "));
    swarm.hivectl_done({"results", "face.faces", "-n", "3", "--as", "yolo", "-o", yolo.string()});
    CHECK(written_in(yolo / "classes.txt") == "face\n");
    std::vector<std::string> labels;
    for (const auto& file : std::filesystem::directory_iterator(yolo / "labels"))
        labels.push_back(written_in(file.path()));
    CHECK(labels.size() == 3);
    CHECK(std::ranges::any_of(labels, [](const auto& text) { return text.starts_with("0 0."); }));
}

TEST_CASE("results --as: a folder in use, a missing folder and results without boxes are refused with the cause")
{
    const Swarm swarm;
    const auto ticker = swarm.drone("ticker", "ticker", {"fps=50"});
    const auto folder = (swarm.home() / "used").string();
    std::filesystem::create_directory(folder);
    std::ofstream(folder + "/note") << "mine";
    const auto used = swarm.hivectl({"results", "ticker.tick", "--as", "coco", "-o", folder});
    CHECK(used.exit_code == 5);
    CHECK(says(used.err, "is not an empty folder"));
    const auto no_folder = swarm.hivectl({"results", "ticker.tick", "--as", "yolo"});
    CHECK(no_folder.exit_code == 2);
    CHECK(says(no_folder.err, "-o FOLDER"));
    CHECK(swarm.hivectl({"results", "ticker.tick", "-o", folder}).exit_code == 2);
    const auto no_boxes = swarm.hivectl({"results", "ticker.tick", "-n", "1", "--as", "csv"});
    CHECK(no_boxes.exit_code == 5);
    CHECK(says(no_boxes.err, "has no boxes"));
    CHECK(says(no_boxes.err, "; name fields of the header: --fields "));
    CHECK(swarm.hivectl({"results", "ticker.tick", "--fields", "tick"}).exit_code == 2);
}

TEST_CASE(
    "results --as csv: fields of the header make a table of any results, and a table that lacks something says so")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"faces=0", "walkers=1"});
    const auto face = swarm.drone("face", "face"),
               zones = swarm.drone("zones", "zones", {"zones=door: 0,0 1,0 1,1 0,1"});
    swarm.hivectl_done({"connect", "camera", "face"});
    swarm.hivectl_done({"connect", "face", "zones"});
    const auto table = swarm.hivectl({"results", "zones.counts", "-n", "2", "--as", "csv", "--fields",
                                      "zones.door.occupancy,width,lines.nowhere.in"});
    CHECK(table.exit_code == 0);
    CHECK(
        table.out.starts_with("source,epoch,seq,time_us,sender,output,zones.door.occupancy,width,lines.nowhere.in\n"));
    CHECK(says(table.out, ",zones,counts,0,640,\n"));
    CHECK(std::ranges::count(table.out, '\n') == 3);
    CHECK(says(table.err, "no result has the field lines.nowhere.in; name fields of the header: --fields "));
    const auto empty = swarm.hivectl({"results", "zones.counts", "-n", "2", "--as", "csv"});
    CHECK(std::ranges::count(empty.out, '\n') == 1);
    CHECK(says(empty.err, "no boxes in 2 results; name fields of the header: --fields "));
}
