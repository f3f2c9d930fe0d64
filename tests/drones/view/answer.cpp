// What is answered, without a socket.
#include "answer.hpp"
#include "status.hpp"

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <set>

using namespace std::chrono_literals;
using nlohmann::json;

namespace {

class Page {
public:
    Page() : exchange(view::Image::of_notice("no image yet")) {}
    view::Answer ask(view::Request request, view::Browsers browsers = {0, 8}) const
    {
        return answer_to(request, exchange, bind_, pass_, browsers);
    }
    view::Answer get(std::string_view path, view::Browsers browsers = {0, 8}) const
    {
        return ask({.method = "GET", .path = path, .host = "127.0.0.1:8080", .cookie = "secret"}, browsers);
    }
    void put()
    {
        view::Origin origin{"face.annotated", "camera", 7, {64, 48}, std::chrono::system_clock::now(), 29.84};
        exchange.put(std::make_shared<const view::Image>(
            origin, view::Image::Content{[] { return cv::Mat(48, 64, CV_8UC1, cv::Scalar::all(1)); }, nullptr},
            view::Image::Look{}));
    }
    view::Exchange exchange;

private:
    view::Address bind_{"127.0.0.1", 8080};
    view::Pass pass_{"secret", "hive-view-8080"};
};

/// The JSON example of the drone's page.
json example()
{
    std::ifstream page(HIVE_SOURCE_DIR "/drones/view/README.md");
    std::string line;
    while (std::getline(page, line))
        if (line.starts_with("{"))
            return json::parse(line);
    return nullptr;
}

std::set<std::string> keys(const json& object)
{
    std::set<std::string> names;
    for (const auto& item : object.items())
        names.insert(item.key());
    return names;
}

}  // namespace

TEST_CASE("answer: the page and all that it names are there, and it names nothing else")
{
    Page page;
    page.put();
    const auto html = page.get("/");
    CHECK(html.type == "text/html; charset=utf-8");
    for (const char* path : {"/view.css", "/view.js", "/status.json", "/plain/stream.mjpg", "/plain/picture.jpg"})
        CHECK_MESSAGE(page.get(path).code == 200, path);
    CHECK(html.body.find("\"plain/stream.mjpg\"") != std::string::npos);
    for (const auto& answer : {html, page.get("/view.css"), page.get("/view.js")})
        CHECK(answer.body.find("//") == std::string::npos);  // neither a URL nor a comment
}

TEST_CASE("answer: another method, path or host gets an error with advice")
{
    const Page page;
    for (const char* method : {"POST", "HEAD", "PUT", "OPTIONS", "get", ""})
        CHECK(page.ask({.method = method, .path = "/", .host = "127.0.0.1", .cookie = "secret"}).code == 405);
    for (const char* path : {"", "/x", "/../etc/passwd", "//", "/view.css/", "/index.html"})
        CHECK(page.get(path).code == 404);
    CHECK(page.ask({"GET", "/status.json", "evil.example"}).code == 403);
    CHECK(page.ask({"POST", "/nothing", "evil.example"}).code == 403);
    CHECK(page.ask({"GET", "/", std::nullopt}).code == 400);
}

TEST_CASE("answer: the snapshot is a JPEG of the newest image, as the server has it; 503 before there is one")
{
    Page page;
    CHECK(page.get("/picture.jpg").code == 503);
    page.put();
    const auto answer = page.get("/picture.jpg");
    CHECK(answer.type == "image/jpeg");
    CHECK(answer.what == view::Answer::image);
}

TEST_CASE("answer: the page gets images without captions, others get them as they are set")
{
    Page page;
    page.put();
    CHECK(page.get("/plain/stream.mjpg").plain);
    CHECK_FALSE(page.get("/stream.mjpg").plain);
    CHECK(page.get("/plain/picture.jpg").plain);
    CHECK_FALSE(page.get("/picture.jpg").plain);
}

TEST_CASE("answer: no more streams than are allowed")
{
    const Page page;
    CHECK(page.get("/stream.mjpg", {7, 8}).what == view::Answer::stream);
    CHECK(page.get("/stream.mjpg", {8, 8}).code == 503);
    CHECK(page.get("/", {8, 8}).what == view::Answer::text);
}

TEST_CASE("status: unknown values are null, and the rate is 0 when images stop")
{
    Page page;
    const json before = json::parse(page.get("/status.json", {2, 8}).body);
    CHECK(before.at("number") == 0);
    CHECK(before.at("sender").is_null());
    CHECK(before.at("browsers") == 2);
    page.put();
    const auto newest = page.exchange.newest();
    const auto now = view::status_of(newest, 1, newest.since + 150ms, *newest.image->origin().captured + 200ms);
    CHECK(now
          == json{{"sender", "face.annotated"},
                  {"source", "camera"},
                  {"sequence", 7},
                  {"number", 1},
                  {"width", 64},
                  {"height", 48},
                  {"rate", 29.8},
                  {"age_ms", 200},
                  {"since_ms", 150},
                  {"browsers", 1}});
    CHECK(view::status_of(newest, 1, newest.since + 2s).at("rate") == 0);
    auto slow = std::make_shared<const view::Image>(view::Origin{.sender = "a.b", .source = "a", .rate = 0.2},
                                                    view::Image::Content{}, view::Image::Look{});
    const view::Exchange::Newest one_in_five_seconds{slow, 2, newest.since};
    CHECK(view::status_of(one_in_five_seconds, 1, newest.since + 9s).at("rate") == 0.2);
    CHECK(view::status_of(one_in_five_seconds, 1, newest.since + 10s).at("rate") == 0);
    CHECK(keys(before) == keys(now));
    CHECK(keys(example()) == keys(now));  // the drone's page shows the same fields
}

TEST_CASE("answer: no page without a token, and each token is random")
{
    const view::Pass closed("", "hive-view-8080");
    const view::Request request{.method = "GET", .path = "/", .host = "127.0.0.1"};
    CHECK_FALSE(closed.in_cookie(request));
    CHECK_FALSE(closed.in_address(request));
    const auto token = view::Pass::draw_token();
    CHECK(token.size() == 32);
    CHECK(token != view::Pass::draw_token());
}
