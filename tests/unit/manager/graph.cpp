// The text for Graphviz: every name is quoted, machines are frames, and what is not there now is dotted.
#include <hive/graph.hpp>

#include <doctest/doctest.h>

using namespace hive;

TEST_CASE("graph: for Graphviz, two machines, a group, an application and a drone that does not answer")
{
    EdgeStatus to_face{.receiver = "face.image", .connected = true, .options = {.group = "all \"faces\"", .lease = {}}};
    EdgeStatus to_gone{.receiver = "gone.image", .connected = false};
    EdgeStatus away{.receiver = "away.image", .connected = false, .why = Reason::place_kept};
    Status camera{.name = "camera", .kind = "camera", .state = State::halted};
    camera.outputs.push_back({.name = "image", .type = {}, .edges = {to_face, to_gone, away}});
    const std::vector<StatusAnswer> statuses{
        {.drone = "camera", .status = camera, .place = {.drone = {}, .host = Place::here, .address = {}}},
        {.drone = "face", .status = Error(Errc::timeout, "no"), .place = {.drone = {}, .host = "cam1", .address = {}}}};
    const auto made = graph(statuses);
    const auto text = to_dot(made);
    CHECK_MESSAGE(text.find(R"(subgraph "cluster local")") != std::string::npos, text);
    CHECK_MESSAGE(
        text.find(R"("camera" [label="camera\ncamera, halted", fillcolor=lightyellow];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"("face" [label="face\nsilent", fillcolor=mistyrose];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"x("camera" -> "face" [label="image (group all \"faces\")"];)x") != std::string::npos,
                  text);
    CHECK_MESSAGE(text.find(R"("camera" -> "away.image" [label="image", style=dotted];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find("gone.image") == std::string::npos, text);
    CHECK(to_text(made)
          == "cam1:\n  face (silent)\n\nlocal:\n  camera (camera, halted)\n"
             "    image -> away.image, not connected\n    image -> face.image (group all \"faces\")\n");
}

TEST_CASE("graph: a drone that crashed stays with its connections, and so does a receiver that events were lost for")
{
    const auto gone = [](const char* receiver, std::int64_t lost) {
        EdgeStatus edge{.receiver = receiver, .connected = false};
        edge.events.came(lost);
        edge.events.went(Fate::lost_killed, lost);
        return edge;
    };
    Status camera{.name = "camera", .kind = "camera"};
    camera.outputs.push_back(
        {.name = "image",
         .type = {},
         .edges = {gone("boom.in", 0), gone("left.in", 0), gone("app-7", 2), gone("again.in", 3)}});
    Status again{.name = "again", .kind = "face"};
    const auto answer = [](const Status& status) {
        return StatusAnswer{
            .drone = status.name, .status = status, .place = {.drone = {}, .host = Place::here, .address = {}}};
    };
    const auto died = [](const char* name) {
        return GraphDrone{.name = name, .host = Place::here, .kind = {}, .state = "crashed", .note = "SIGSEGV"};
    };
    const auto made = graph({answer(camera), answer(again)}, {died("again"), died("boom")});
    CHECK(to_text(made)
          == "local:\n  again (face, starting)\n  boom (crashed)\n  camera (camera, starting)\n"
             "    image -> app-7, not connected\n    image -> boom.in, not connected\n");
    const auto text = to_dot(made);
    CHECK_MESSAGE(text.find(R"("boom" [label="boom\ncrashed", fillcolor=mistyrose];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"("camera" -> "boom" [label="image", style=dotted];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"("app-7" [label="app-7\ngone", style=dashed];)") != std::string::npos, text);
    CHECK(graph({answer(camera), answer(again)}).drones.size() == 3);
}

TEST_CASE("graph: no name that a peer reports reaches a terminal or Graphviz with control characters")
{
    Status camera{.name = "camera", .kind = "camera"};
    camera.outputs.push_back(
        {.name = "image", .type = {}, .edges = {EdgeStatus{.receiver = "app\x1b[2J", .connected = true}}});
    const auto made =
        graph({{.drone = "camera", .status = camera, .place = {.drone = {}, .host = Place::here, .address = {}}}});
    for (const auto& text : {to_text(made), to_dot(made)}) {
        CHECK_MESSAGE(text.find('\x1b') == std::string::npos, text);
        CHECK_MESSAGE(text.find("\\x1b[2J") != std::string::npos, text);
    }
}
