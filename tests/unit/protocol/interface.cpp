// The interface goes to JSON and back unchanged.
#include <hive/error.hpp>
#include <hive/interface.hpp>

#include <doctest/doctest.h>

#include <limits>

using namespace hive;

namespace {

Interface face()
{
    Interface face;
    face.kind = "face";
    face.summary = "Finds faces.";
    face.version = "0.1.0";
    face.stateful = true;
    face.inputs = {{"image", "image/*", "the picture"}};
    face.outputs = {
        {"faces", "application/json", ""},
        {"annotated", "image/jpeg,image/png", "with boxes", {{"jpeg", "image/jpeg", 1, 100}, {"png", "image/png"}}}};
    face.parameters = {
        {"scale", ParameterType::number, 1.1, 1.01, 2.0, {}, "", "step"},
        {"min", ParameterType::integer, 40, 1, std::nullopt, {}, "px", ""},
        {"format", ParameterType::text, "jpeg", std::nullopt, std::nullopt, {"jpeg", "png"}, "", ""},
        {"draw", ParameterType::flag, true, std::nullopt, std::nullopt, {}, "", "Größe \"x\""},
    };
    return face;
}

}  // namespace

TEST_CASE("interface: what was written is read, through text")
{
    const Json written = to_json(face());
    const Interface read = interface_from_json(parse_json(to_text(written)));
    CHECK_EQ(to_json(read), written);
    CHECK_EQ(read.kind, "face");
    CHECK(read.stateful);
    CHECK(read.outputs[0].encodings.empty());
    CHECK(read.outputs[1].encodings == face().outputs[1].encodings);
    REQUIRE_EQ(read.parameters.size(), 4u);
    CHECK_EQ(read.parameters[0].most, 2.0);
    CHECK_FALSE(read.parameters[1].most.has_value());
    CHECK_EQ(read.parameters[2].choices.size(), 2u);
    CHECK_EQ(read.parameters[3].default_value, true);
}

TEST_CASE("interface: ports and parameters are found by name, and only by the whole name")
{
    const Interface interface = face();
    REQUIRE(interface.output("annotated"));
    CHECK_EQ(interface.output("annotated")->type, "image/jpeg,image/png");
    CHECK(interface.input("image"));
    CHECK(interface.parameter("draw"));
    CHECK_FALSE(interface.input("imag"));
    CHECK_FALSE(interface.output("image"));
    CHECK_FALSE(interface.parameter(""));
}

TEST_CASE("interface: a bound that is infinite is no bound on the wire")
{
    Interface interface = face();
    interface.parameters[1].most = std::numeric_limits<double>::infinity();
    const Interface read = interface_from_json(parse_json(to_text(to_json(interface))));
    CHECK_EQ(read.parameters[1].least, 1.0);
    CHECK_FALSE(read.parameters[1].most.has_value());
}

TEST_CASE("interface: the bounds of an integer are written as integers, and a default that is not known is left out")
{
    Interface interface = face();
    interface.parameters[0].default_value = nullptr;
    const Json parameters = to_json(interface).at("parameters");
    CHECK_FALSE(parameters[0].contains("default"));
    CHECK(parameters[0].at("max").is_number_float());
    CHECK(parameters[1].at("min").is_number_integer());
    CHECK_EQ(to_text(parameters[1].at("min")), "1");
}

TEST_CASE("interface: a drone of many ports still fits a header")
{
    Interface wide = face();
    for (int i = 0; i < 200; ++i)
        wide.outputs.push_back(
            {"output-" + std::to_string(i), "application/json", "one of many, with a help text of its own"});
    CHECK_EQ(to_json(interface_from_json(parse_json(to_text(to_json(wide))))), to_json(wide));
}
