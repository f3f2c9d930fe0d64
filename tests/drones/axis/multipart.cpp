// Streams of images in every form that cameras write, in pieces of every size.
#include "multipart.hpp"
#include "camera_error.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace {

using axis::Failure;
using axis::MultipartReader;
using Texts = std::vector<std::string>;

const std::string one = "\xFF\xD8one\r\n--mybound\xFF\xD9", two = "\xFF\xD8 two \n\n\xFF\xD9";

std::string part(const std::string& bytes, const std::string& head = "", const std::string& end = "\r\n")
{
    return "--myboundary" + end + "Content-Type: image/jpeg" + end + head + end + bytes + end;
}

std::string counted(const std::string& bytes, const std::string& end = "\r\n")
{
    return part(bytes, "Content-Length: " + std::to_string(bytes.size()) + end, end);
}

/// The bytes of the parts of `stream`, fed in pieces of `piece` bytes.
Texts parts_of(const std::string& stream, std::size_t piece, const std::string& boundary = "myboundary")
{
    MultipartReader reader(boundary);
    Texts result;
    const auto take = [&] {
        while (auto found = reader.next())
            result.push_back(found->bytes);
    };
    for (std::size_t at = 0; at < stream.size(); at += piece) {
        reader.feed(std::string_view(stream).substr(at, piece));
        take();
    }
    reader.finish();
    take();
    return result;
}

/// However the stream is cut into pieces, the parts are the same.
void check_parts(const std::string& stream, const Texts& expected, const std::string& boundary = "myboundary")
{
    for (const std::size_t piece : {1, 2, 3, 7, 13, 64, 100000})
        CHECK(parts_of(stream, piece, boundary) == expected);
}

Failure failure_of(const std::string& stream)
{
    try {
        parts_of(stream, 4096);
    } catch (const axis::CameraError& error) {
        return error.kind();
    }
    return Failure::cancelled;
}

}  // namespace

TEST_CASE("multipart: the boundary is read from every form of Content-Type")
{
    CHECK(axis::boundary_of("multipart/x-mixed-replace; boundary=myboundary") == "myboundary");
    CHECK(axis::boundary_of("multipart/x-mixed-replace;boundary=--myboundary") == "--myboundary");
    CHECK(axis::boundary_of("Multipart/x-mixed-replace; Boundary=\"my boundary\"; charset=x") == "my boundary");
    CHECK(axis::boundary_of("multipart/x-mixed-replace; boundary=b ; charset=x") == "b");
    CHECK_FALSE(axis::boundary_of("multipart/x-mixed-replace"));
    CHECK_FALSE(axis::boundary_of("multipart/x-mixed-replace; boundary="));
    CHECK_FALSE(axis::boundary_of("multipart/x-mixed-replace; boundary=--"));
    CHECK_FALSE(axis::boundary_of("multipart/x-mixed-replace; boundary=\""));
    CHECK_FALSE(axis::boundary_of("text/html"));
    CHECK_FALSE(axis::boundary_of("image/jpeg; boundary=x"));
}

TEST_CASE("multipart: parts with their length, without it, and with line ends of one byte")
{
    check_parts(counted(one) + counted(two), {one, two});
    check_parts(counted(one, "\n") + counted(two, "\n"), {one, two});
    check_parts(part(one) + part(two) + "--myboundary\r\n", {one, two});
    check_parts(part(one, "", "\n") + part(two, "", "\n") + "--myboundary\n", {one, two});
    check_parts(part(one, "content-length:many\r\n") + counted(two), {one, two});
}

TEST_CASE("multipart: every name of the boundary, line end and length gives whole parts with their type")
{
    const std::string jpeg = "\xFF\xD8 image \r\n\r\n \xFF\xD9", size = std::to_string(jpeg.size());
    for (const char* name :
         {" boundary=myboundary", " boundary=--myboundary", " boundary=\"myboundary\"", "boundary=myboundary"})
        for (const std::string end : {"\r\n", "\n"})
            for (const std::string& head :
                 {"Content-Length: " + size + end, std::string(), "Content-Length: many" + end,
                  "X-Unknown: \xE4\x01\xFF" + end + "Content-Length: " + size + end}) {
                CAPTURE(std::string(name) + " " + head);
                const auto boundary = axis::boundary_of(std::string("multipart/x-mixed-replace;") + name);
                REQUIRE(boundary);
                MultipartReader reader(*boundary);
                reader.feed(part(jpeg, head, end) + part(jpeg, head, end) + part(jpeg, head, end));
                for (int i = 0; i < 2; ++i) {
                    const auto found = reader.next();
                    REQUIRE(found);
                    CHECK(found->bytes == jpeg);
                    CHECK(found->type == "image/jpeg");
                }
            }
}

TEST_CASE("multipart: dashes of the boundary may be too many or too few, in the header and in the stream")
{
    for (const char* told : {"myboundary", "--myboundary", "----myboundary"}) {
        check_parts(counted(one) + part(two) + "--myboundary", {one, two}, told);
        check_parts(part(one) + "--" + part(two) + "----myboundary--\r\n", {one, two}, told);
    }
}

TEST_CASE("multipart: unknown fields, a preamble, garbage between parts and a closing boundary are passed over")
{
    check_parts("hello\r\n\r\n"
                    + part(one, "X-Axis: 1\r\nnonsense\r\nContent-Length: " + std::to_string(one.size()) + "\r\n")
                    + "\xFF\xD8 -- --my \xFF\xD9\r\n" + counted(two) + "--myboundary--\r\n",
                {one, two});
}

TEST_CASE("multipart: a length that is too small or too large costs images, never the stream")
{
    const std::string image(3000, 'p');
    check_parts(part(image, "Content-Length: 1000\r\n") + counted(two), {image.substr(0, 1000), two});
    const auto found = parts_of(part(one, "Content-Length: 40\r\n") + counted(two) + counted(one) + counted(two), 10);
    REQUIRE(found.size() >= 3);
    CHECK(found[0] != one);
    CHECK(Texts(found.end() - 2, found.end()) == Texts{one, two});
}

TEST_CASE("multipart: a part that is cut by the end of the stream is given only if it had no length to break")
{
    check_parts(counted(one) + "--myboundary\r\nContent-Length: 100\r\n\r\nabc", {one});
    check_parts(part(one) + "--myboundary\r\nContent-Type: image/jpeg\r\n\r\n" + two, {one, two});
    check_parts("--myboundary\r\nContent-Type: image/jp", {});
}

TEST_CASE("multipart: every size has a limit, found out while reading")
{
    CHECK(failure_of("--myboundary\r\nContent-Length: 16777217\r\n\r\n") == Failure::too_large);
    CHECK(failure_of("--myboundary\r\nContent-Length: 99999999999999999999999\r\n\r\n") == Failure::too_large);
    CHECK(failure_of("--myboundary\r\nContent-Type: " + std::string(9000, 'x')) == Failure::too_large);
    CHECK(failure_of("--myboundary" + std::string(9000, 'x')) == Failure::too_large);
    std::string fields;
    for (int i = 0; i < 1000; ++i)
        fields += "X-" + std::to_string(i) + ": y\r\n";
    CHECK(failure_of("--myboundary\r\n" + fields) == Failure::too_large);
    const std::string megabytes((16u << 20) + 5000, 'x');
    CHECK(failure_of("--myboundary\r\nContent-Type: image/jpeg\r\n\r\n" + megabytes) == Failure::too_large);
    CHECK(failure_of(megabytes) == Failure::not_an_image);
}
