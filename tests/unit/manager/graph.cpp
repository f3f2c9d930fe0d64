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
        {.drone = "camera", .status = camera, .error = {}, .place = {.drone = {}, .host = Place::here, .address = {}}},
        {.drone = "face",
         .status = {},
         .error = Error(Errc::timeout, "no"),
         .place = {.drone = {}, .host = "cam1", .address = {}}}};
    const auto made = graph(statuses);
    const auto text = to_dot(made);
    CHECK_MESSAGE(text.find(R"(subgraph "cluster local")") != std::string::npos, text);
    CHECK_MESSAGE(
        text.find(R"("camera" [label="camera\ncamera, halted", fillcolor=lightyellow];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"("face" [label="face\nsilent", fillcolor=mistyrose];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find(R"x("camera" -> "face" [label="image (group all \"faces\")"];)x") != std::string::npos,
                  text);
    CHECK_MESSAGE(text.find(R"("camera" -> "away.image" [label="image", style=dotted];)") != std::string::npos, text);
    CHECK_MESSAGE(text.find("gone") == std::string::npos, text);
    CHECK(to_text(made)
          == "cam1:\n  face (silent)\n\nlocal:\n  camera (camera, halted)\n"
             "    image -> away.image, not connected\n    image -> face.image (group all \"faces\")\n");
}

TEST_CASE("graph: no name that a peer reports reaches a terminal or Graphviz with control characters")
{
    Status camera{.name = "camera", .kind = "camera"};
    camera.outputs.push_back(
        {.name = "image", .type = {}, .edges = {EdgeStatus{.receiver = "app\x1b[2J", .connected = true}}});
    const auto made = graph({{.drone = "camera",
                              .status = camera,
                              .error = {},
                              .place = {.drone = {}, .host = Place::here, .address = {}}}});
    for (const auto& text : {to_text(made), to_dot(made)}) {
        CHECK_MESSAGE(text.find('\x1b') == std::string::npos, text);
        CHECK_MESSAGE(text.find("\\x1b[2J") != std::string::npos, text);
    }
}
