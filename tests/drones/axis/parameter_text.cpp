// The text of param.cgi, as cameras of several generations write it.
#include "parameter_text.hpp"

#include <doctest/doctest.h>

using namespace axis;

TEST_CASE("parameters: names lose their root, values keep everything after the first equals sign")
{
    const auto list = parse_parameters(
        "root.Image.I0.Appearance.Resolution=640x480\r\nBrand.Brand=AXIS\nroot.A.B=x=y\nroot.Empty=\r\n");
    CHECK(list.values
          == Parameters{
              {"Image.I0.Appearance.Resolution", "640x480"}, {"Brand.Brand", "AXIS"}, {"A.B", "x=y"}, {"Empty", ""}});
    CHECK(list.errors.empty());
}

TEST_CASE("parameters: an error among them does not hide the others")
{
    const auto list = parse_parameters("# Error: Error -1 getting param in group 'X'!\nroot.A=1\n");
    CHECK(list.errors == std::vector<std::string>{"Error: Error -1 getting param in group 'X'!"});
    CHECK(list.values == Parameters{{"A", "1"}});
}

TEST_CASE("parameters: Latin-1 becomes UTF-8, UTF-8 stays")
{
    CHECK(parse_parameters("root.Name=Fu\xDFg\xE4nger").values.at("Name") == "Fu\xC3\x9Fg\xC3\xA4nger");
    CHECK(parse_parameters("root.Name=Fu\xC3\x9Fg\xC3\xA4nger").values.at("Name") == "Fu\xC3\x9Fg\xC3\xA4nger");
}

TEST_CASE("parameters: a web page has no parameters")
{
    CHECK(parse_parameters("<html>\n<a href=\"x\">\n</html>").values.empty());
    CHECK(parse_parameters("").values.empty());
}

TEST_CASE("parameters: an update was taken when the answer is OK and nothing else")
{
    CHECK_FALSE(refusal_of("OK"));
    CHECK_FALSE(refusal_of("OK\r\n"));
    CHECK(refusal_of("# Error: Error setting 'root.A' to '9'!\r\n") == "Error: Error setting 'root.A' to '9'!");
    CHECK(refusal_of("# Request failed: no\n# Error: two\n") == "Request failed: no; Error: two");
    CHECK(refusal_of("") == "the answer is \"\"");
    CHECK(refusal_of("<html>\nno") == "the answer is \"<html>\"");
}

TEST_CASE("parameters: what a query carries cannot become another word of it")
{
    CHECK(list_query({"Brand", "Image.I0"}) == "action=list&group=Brand,Image.I0");
    CHECK(update_query({{"A.B", "1&C=2 \xC3\xA4"}}) == "action=update&A.B=1%26C%3D2%20%C3%A4");
}

TEST_CASE("parameters: what a camera writes at length is cut off at the door")
{
    const std::string endless(60'000, '9');
    CHECK(parse_parameters("root.A=" + endless + "\n").values.at("A").size() == 2000);
    std::string errors;
    for (int i = 0; i < 10; ++i)
        errors += "# Error: " + endless + "\n";
    CHECK(refusal_of(errors)->size() <= 4000);
    CHECK(refusal_of("# Error: " + std::string(60'000, '\xE4') + "\n")->size() <= 4000);  // Latin-1 becomes longer
}
