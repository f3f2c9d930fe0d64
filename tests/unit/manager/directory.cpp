// Where drones are: the list of places in its file, and what a name means when several places have it.
#include "directory.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <optional>
#include <unistd.h>
#include <vector>

namespace hive {
namespace {

namespace fs = std::filesystem;

class FreshHome {
public:
    FreshHome()
    {
        std::string name = "/tmp/hv-XXXXXX";
        REQUIRE(::mkdtemp(name.data()));
        path_ = name;
    }
    ~FreshHome()
    {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    FreshHome(const FreshHome&) = delete;
    FreshHome& operator=(const FreshHome&) = delete;
    [[nodiscard]] const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

Place place_of(const std::string& drone, const std::string& host, int port = 7700)
{
    return {.drone = drone, .host = host, .address = "tcp://" + host + ":" + std::to_string(port)};
}

std::string address_found(const Directory& directory, const std::string& reference)
{
    const auto place = directory.find(reference);
    return place ? place->address : "";
}

/// Runs as far as the directory can tell: the socket's file is there, and somebody holds the lock.
class LocalDrone {
public:
    LocalDrone(const event::Home& home, const std::string& name) : claim_(home, name)
    {
        std::ofstream(home.path(name, ".sock"));
    }

private:
    event::NameClaim claim_;
};

}  // namespace

TEST_CASE("endpoint: the part after the last dot is the port, since a drone's name may have dots")
{
    for (const auto& end : std::vector<Endpoint>{{"camera", ""}, {"camera", "image"}, {"cam.2", "image"}})
        CHECK(parse_endpoint(to_text(end)) == end);
    CHECK(parse_endpoint("camera.") == Endpoint{"camera", ""});
}

TEST_CASE("place list: what one process writes another reads, and what is forgotten is gone")
{
    const FreshHome home;
    PlaceList writer(home.path()), reader(home.path());
    CHECK(reader.places().empty());
    auto camera = place_of("camera", "cam1");
    camera.ssh = "me@cam1";
    writer.add(camera);
    writer.add(place_of("face", "gpu1"));
    CHECK(reader.places() == std::vector{camera, place_of("face", "gpu1")});
    CHECK(writer.forget(camera));
    CHECK_FALSE(writer.forget(camera));
    CHECK(reader.places() == std::vector{place_of("face", "gpu1")});
}

TEST_CASE("place list: where a drone was started again, what was said of it at that host before is gone")
{
    const FreshHome home;
    PlaceList list(home.path());
    for (const auto& place : {place_of("camera", "cam1", 7700), place_of("camera", "cam1", 7701),
                              place_of("camera", "cam2", 7700), place_of("face", "cam1", 7702)})
        list.add(place);
    list.replace({place_of("camera", "cam1", 7705), place_of("gesture", "cam1", 7701)});
    CHECK(list.places()
          == std::vector{place_of("camera", "cam1", 7705), place_of("camera", "cam2", 7700),
                         place_of("face", "cam1", 7702), place_of("gesture", "cam1", 7701)});
    CHECK_THROWS_AS(list.replace({place_of("camera", "cam1", 0)}), Error);
    list.replace({});
    CHECK(list.places().size() == 4);
}

TEST_CASE("place list: it remembers when a drone has answered, and only of those that it has")
{
    const FreshHome home;
    PlaceList list(home.path());
    list.add(place_of("camera", "cam1"));
    list.answered({place_of("camera", "cam1"), place_of("face", "gpu1")});
    REQUIRE(list.places().size() == 1);
    const auto answered = list.places().front().answered_us;
    CHECK(answered > 1'600'000'000'000'000);
    list.answered(list.places());  // at once again: not worth a write
    CHECK(list.places().front().answered_us == answered);
}

TEST_CASE("place list: what cannot be a place is refused, and a damaged file is named")
{
    const FreshHome home;
    PlaceList list(home.path());
    for (const auto& bad : {place_of("..", "cam1"), place_of("camera", "cam1", 0), place_of("camera", Place::here),
                            Place{.drone = "camera", .host = "cam1", .address = "unix:/tmp/camera.sock"},
                            Place{.drone = "camera", .host = "cam1", .address = "cam1:7700"},
                            Place{.drone = "camera", .host = "", .address = "tcp://cam1:7700"}})
        CHECK_THROWS_AS(list.add(bad), Error);
    CHECK(list.places().empty());
    std::ofstream(home.path() / ".places") << R"({"places": [{"drone": "camera"}]})";
    try {
        (void)list.places();
        FAIL("it was read");
    } catch (const Error& error) {
        CHECK(error.code() == Errc::malformed);
        CHECK(std::string(error.what()).find(".places") != std::string::npos);
    }
}

TEST_CASE("directory: a name alone means the one drone that has it, wherever it is")
{
    const FreshHome home;
    Directory directory(home.path());
    const LocalDrone face(directory.home(), "face");
    directory.list().add(place_of("camera", "cam1"));
    CHECK(address_found(directory, "camera") == "tcp://cam1:7700");
    CHECK(address_found(directory, "camera@cam1") == "tcp://cam1:7700");
    CHECK(address_found(directory, "face").starts_with("unix:/"));
    CHECK(address_found(directory, "face@local").starts_with("unix:/"));
    for (const auto* nobody : {"gesture", "face@cam1", "camera@local", "camera@", "@cam1", ""})
        CHECK_MESSAGE(address_found(directory, nobody).empty(), nobody);
    CHECK(directory.names() == std::vector<std::string>{"camera", "face"});
}

TEST_CASE("directory: a drone that is being replaced is found between the sockets of the two processes")
{
    const FreshHome home;
    Directory directory(home.path());
    const auto& here = directory.home();
    here.write_state("face", Json::object());
    std::optional<event::NameClaim> successor(std::in_place, here, "face", event::NameClaim::To::succession);
    CHECK(directory.names() == std::vector<std::string>{"face"});
    CHECK(address_found(directory, "face").starts_with("unix:/"));
    successor.reset();
    CHECK(directory.names().empty());
    const event::NameClaim swarm(here, "work.swarm", event::NameClaim::To::succession);  // of a waiting up
    CHECK(directory.names().empty());
}

TEST_CASE("directory: where several have a name it is refused alone, and each is called by its host, or host and port")
{
    const FreshHome home;
    Directory directory(home.path());
    const LocalDrone camera(directory.home(), "camera");
    directory.list().add(place_of("camera", "cam1"));
    directory.list().add(place_of("camera", "cam2", 7700));
    directory.list().add(place_of("camera", "cam2", 7701));
    CHECK(directory.names()
          == std::vector<std::string>{"camera@local", "camera@cam1", "camera@cam2:7700", "camera@cam2:7701"});
    for (const auto& name : directory.names())
        CHECK_MESSAGE(!address_found(directory, name).empty(), name);
    CHECK(address_found(directory, "camera@cam2:7701") == "tcp://cam2:7701");
    for (const auto* several : {"camera", "camera@cam2"})
        try {
            (void)directory.find(several);
            FAIL(several, " means one");
        } catch (const Error& error) {
            CHECK(error.code() == Errc::invalid_argument);
            CHECK(error.advice().find("camera@cam2:7700") != std::string::npos);
        }
}

}  // namespace hive
