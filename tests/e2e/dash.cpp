// hivectl dash: permissions to read and change, over HTTP; and each control, in a real browser.
#include "dash_browser.hpp"
#include "dash_server.hpp"
#include "successors.hpp"

#include <doctest/doctest.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>

using namespace hive::test;
using namespace std::chrono_literals;
using hive::Json;

namespace {

Json json_of(const std::string& answer) { return Json::parse(answer.substr(0, answer.size() - 3)); }

/// A fake program dot that takes half a minute and reports its start; during the object's lifetime it is the first in
/// the path.
class SlowDot {
public:
    explicit SlowDot(const Swarm& swarm) : begun_(swarm.home() / "drawing")
    {
        const auto folder = swarm.home() / "programs";
        std::filesystem::create_directories(folder);
        std::ofstream(folder / "dot") << "#!/bin/sh\ntouch " << begun_ << "\nexec sleep 30\n";
        std::filesystem::permissions(folder / "dot", std::filesystem::perms::owner_all);
        ::setenv("PATH", (folder.string() + ":" + path_).c_str(), 1);
    }
    ~SlowDot() { ::setenv("PATH", path_.c_str(), 1); }
    SlowDot(const SlowDot&) = delete;
    SlowDot& operator=(const SlowDot&) = delete;
    [[nodiscard]] bool begun() const { return std::filesystem::exists(begun_); }

private:
    const std::string path_ = std::getenv("PATH");
    const std::filesystem::path begun_;
};

void in_browser(const std::string& scenario, const std::string& file = "dash_page")
{
    if (!possible(missing_for_browser()))
        return;
    const Swarm swarm;
    const auto done = swarm.run(browser_words(file, scenario), 90'000ms);
    CHECK_MESSAGE(done.exit_code == 0, done.out, done.err);
}

}  // namespace

TEST_CASE("dash: who has not the token sees nothing, and other sites change nothing")
{
    const Swarm swarm;
    const auto camera = swarm.drone("ticker", "camera");
    Page page(swarm);
    const std::string order = R"({"do": "halt", "drone": "camera"})";
    const auto halted = [&] { return swarm.application().status("camera").state == hive::State::halted; };
    for (const auto* path : {"/", "/events", "/dash.js", "/graph.svg", "/drone/camera", "/ask/camera",
                             "/image/camera.tick/320/0", "/failure/camera/1", "/advice/camera/fps"}) {
        CHECK_MESSAGE(page.curl(path, {}).ends_with("403"), path);
        CHECK_MESSAGE(page.curl(path, {"-b", page.cookie(), "-H", "Host: evil.example"}).ends_with("403"), path);
        CHECK_MESSAGE(page.curl(path, {"-b", page.cookie(), "-H", "Sec-Fetch-Site: cross-site"}).ends_with("403"),
                      path);
    }
    const auto refused = [&](const std::vector<std::string>& words, const char* code) {
        auto line = words;
        line.insert(line.end(), {"--data-binary", order});
        CHECK_MESSAGE(page.curl("/orders", line).ends_with(code), words.back());
    };
    const std::string cookie = page.cookie(), origin = "Origin: " + page.address(),
                      type = "Content-Type: application/json";
    refused({"-H", origin, "-H", type}, "403");
    refused({"-b", cookie, "-H", type}, "403");
    refused({"-b", cookie, "-H", type, "-H", "Origin: http://127.0.0.1:1"}, "403");
    refused({"-b", cookie, "-H", origin, "-H", type, "-H", "Sec-Fetch-Site: same-site"}, "403");
    refused({"-b", cookie, "-H", origin}, "415");
    refused({"-b", cookie, "-H", origin, "-H", type, "-X", "PUT"}, "405");
    CHECK_FALSE(halted());
    CHECK(page.post(order) == "{}200");
    CHECK(halted());
    page.stop();
}

TEST_CASE("dash: the address sets a cookie that scripts and other sites do not get, and stays the same")
{
    const Swarm swarm;
    std::string token;
    {
        Page page(swarm);
        token = page.token();
        const auto head = page.curl("/?token=" + token, {"-i"});
        CHECK_MESSAGE(has(head, "303"), head);
        CHECK_MESSAGE(has(head, "; HttpOnly; SameSite=Strict"), head);
        CHECK_MESSAGE(has(head, "Content-Security-Policy: default-src 'self'"), head);
        CHECK(has(page.get("/"), "<!DOCTYPE html>"));
        page.stop();
    }
    namespace fs = std::filesystem;
    CHECK((fs::status(swarm.home() / "dash.token").permissions() & fs::perms(077)) == fs::perms::none);
    const Page again(swarm);
    CHECK(again.token() == token);
}

TEST_CASE("dash: orders are done, and what drones refuse is said")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source"), worker = swarm.drone("sleeper", "worker");
    const Page page(swarm);
    CHECK(json_of(page.post(R"({"do": "set", "drone": "source", "values": {"fps": 20}})"))
          == Json{{"values", {{"fps", 20.0}}}});
    const auto refused = json_of(page.post(R"({"do": "set", "drone": "source", "values": {"fps": -1}})"));
    CHECK_MESSAGE(refused.at("error").at("code") == "refused", refused.dump());
    CHECK(json_of(page.post(R"({"do": "halt", "drone": "nobody"})")).at("error").at("code") == "not_found");
    const auto there_is_none = json_of(page.post(R"({"do": "connect", "from": "source.tick", "to": "worker.image"})"));
    CHECK_MESSAGE(has(there_is_none.dump(), "not connected"), there_is_none.dump());
    for (const auto* malformed : {"", "{", "[]", R"({"do": "dance", "drone": "source"})", R"({"do": 1})",
                                  R"({"do": "set", "drone": "source"})"})
        CHECK_MESSAGE(page.post(malformed).ends_with("400"), malformed);
    CHECK(page.post(std::string(70'000, ' ')).ends_with("413"));
    CHECK(page.get("/orders").ends_with("404"));
    CHECK(page.get("/nothing").ends_with("404"));
    CHECK(json_of(page.get("/ask/worker")).at("interface").at("kind") == "sleeper");
}

TEST_CASE("dash: the stream has drones, connections and the verdict, and a drone that hangs does not delay them")
{
    const Swarm swarm;
    const auto source = swarm.drone("ticker", "source"), worker = swarm.drone("sleeper", "worker");
    const auto hung = swarm.drone("sleeper", "hung");
    swarm.application().connect({"source", ""}, {"worker", ""});
    const Page page(swarm, {"--timeout", "3"});
    const auto stream = [&] {
        return swarm
            .run({"/usr/bin/timeout", "4", "/usr/bin/curl", "-sN", "-b", page.cookie(), page.address() + "/events"})
            .out;
    };
    Json last;
    REQUIRE(eventually([&] {
        const auto text = stream();
        const auto from = text.rfind("data: ", text.rfind("\n\n")) + 6;
        last = has(text, "data: {") ? Json::parse(text.substr(from, text.find("\n\n", from) - from)) : Json();
        return !last.is_null() && last.at("edges").size() == 1 && last.at("edges")[0].at("per_s").is_number();
    }));
    CHECK(last.at("drones").size() == 3);
    REQUIRE(last.at("edges").size() == 1);
    CHECK(last.at("edges")[0].at("id") == "source.tick>worker.image>");
    CHECK(last.at("edges")[0].at("per_s").get<double>() > 5);
    CHECK(last.at("bar").at("clean") == true);
    CHECK(last.at("bar").at("machines")[0].at("drones") == 3);
    CHECK(json_of(page.get("/edge/source.tick%3Eworker.image%3E")).at("audit").at("verdict") == "ok");

    hung.signal(SIGSTOP);
    const auto asking = swarm.run(
        {"/bin/bash", "-c",
         "for i in 1 2 3 4 5 6; do curl -s -m 10 -b " + page.cookie() + " " + page.address()
             + "/ask/hung > $HIVE_HOME/hung-$i & done; sleep 0.3; time=$(curl -s -o /dev/null -w "
               "'%{time_total}' -b "
             + page.cookie() + " " + page.address() + "/drone/worker); wait; echo $time; cat $HIVE_HOME/hung-1"});
    hung.signal(SIGCONT);
    CHECK_MESSAGE(std::stod(asking.out) < 2.5, asking.out);  // of the 3 s for which the others wait
    CHECK_MESSAGE(has(asking.out, "\"error\""), asking.out);
}

TEST_CASE("dash: an order waits for no drone but its own")
{
    const Swarm swarm;
    const auto good = swarm.drone("sleeper", "good");
    std::vector<Process> hung;
    for (int i = 1; i <= 6; ++i)
        hung.push_back(swarm.drone("sleeper", "hung-" + std::to_string(i)));
    const Page page(swarm, {"--timeout", "30"});
    std::vector<Process> asking;
    for (int i = 1; i <= 6; ++i) {
        hung[i - 1U].signal(SIGSTOP);
        const auto drone = "hung-" + std::to_string(i);
        asking.push_back(page.begin("/ask/" + drone));
        asking.push_back(page.begin("/orders", R"({"do": "halt", "drone": ")" + drone + R"("})"));
    }
    std::this_thread::sleep_for(300ms);  // until they have arrived: nothing shows that
    const auto begin = Clock::now();
    CHECK(page.post(R"({"do": "halt", "drone": "good"})") == "{}200");
    CHECK(Clock::now() - begin < stated(1000ms));
    for (auto& each : asking)
        CHECK_FALSE(each.wait(0ms));
}

TEST_CASE("dash: Ctrl-C ends it within a second or so, whatever is under way")
{
    const Swarm swarm;
    swarm.hivectl_done({"start", "sleeper", "--as", "worker"});
    const auto before = swarm.application().status("worker").pid;
    swarm.hivectl_done({"set", "worker", "start_ms=20000"});
    const auto hung = swarm.drone("ticker", "hung");
    hung.signal(SIGSTOP);
    const SlowDot dot(swarm);
    Page page(swarm, {"--timeout", "30"});
    const std::array under_way{page.begin("/events"), page.begin("/ask/hung"), page.begin("/image/hung.tick/320/0"),
                               page.begin("/orders", R"({"do": "halt", "drone": "hung"})"),
                               page.begin("/orders", R"({"do": "replace", "drone": "worker"})")};
    CHECK(eventually([&] { return dot.begun(); }));
    CHECK(eventually([&] { return !successors(swarm).empty(); }));
    const auto begin = Clock::now();
    page.stop();
    CHECK(Clock::now() - begin < stated(1500ms));
    CHECK(eventually([&] { return successors(swarm).empty(); }));
    CHECK(swarm.application().status("worker").pid == before);
}

TEST_CASE("dash: an image is a JPEG of the width that is asked for, and an output without images says so")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"width=1280", "height=720"});
    const auto ticker = swarm.drone("ticker", "ticker");
    const Page page(swarm);
    const auto file = (swarm.home() / "image.jpg").string();
    REQUIRE(eventually([&] {
        return page.curl("/image/camera.image/300/0", {"-b", page.cookie(), "-o", file}) == "200";
    }));
    const auto kind = swarm.run({"/usr/bin/file", file}).out;
    CHECK_MESSAGE(has(kind, "JPEG"), kind);
    CHECK_MESSAGE(has(kind, "320x180"), kind);
    CHECK(eventually([&] { return has(page.get("/image/nobody.image/300/0"), "503"); }));
    CHECK(eventually([&] { return has(page.get("/image/ticker.nothing/300/0"), "nothing"); }));
}

TEST_CASE("dash: the image at which a drone failed is a JPEG that is shrunk to its box, also once it died")
{
    const Swarm swarm;
    const auto camera = swarm.drone("camera", "camera", {"width=1920", "height=1080"});
    const auto ticker = swarm.drone("ticker", "ticker");
    auto boom = swarm.drone("sleeper", "boom", {"throw_at=1"}), other = swarm.drone("sleeper", "other", {"throw_at=1"});
    auto application = swarm.application();
    application.connect({"camera", ""}, {"boom", ""});
    application.connect({"ticker", ""}, {"other", ""});
    REQUIRE(eventually([&] { return application.failing().size() == 2; }));
    boom.signal(SIGKILL);
    CHECK(boom.wait(patient(10s)));
    const Page page(swarm);
    const auto file = (swarm.home() / "image.jpg").string();
    CHECK(page.curl("/failure/boom/1", {"-b", page.cookie(), "-o", file}) == "200");
    const auto kind = swarm.run({"/usr/bin/file", file}).out;
    CHECK_MESSAGE(has(kind, "JPEG"), kind);
    CHECK_MESSAGE(has(kind, "640x360"), kind);
    for (const auto* path : {"/failure/other/1", "/failure/boom/99", "/failure/boom/x", "/failure/..%2Fboom/1"})
        CHECK_MESSAGE(page.get(path).ends_with("404"), path);
    const auto asked = json_of(page.get("/ask/boom"));
    CHECK(asked.at("failures").at(0).at("image") == true);
    CHECK(has(asked.at("failures").at(0).at("inputs").at(0).at("header").get<std::string>(), "\"width\":1920"));
    CHECK_FALSE(asked.contains("interface"));
    CHECK(json_of(page.get("/ask/other")).at("failures").at(0).at("image") == false);
}

TEST_CASE("dash in a browser: a parameter is set at once, with the drone's answer") { in_browser("parameters"); }

TEST_CASE("dash in a browser: halt, resume, replace, and stop when asked once more") { in_browser("buttons"); }

TEST_CASE("dash in a browser: a connection has its account, and takes another window, encoding and transfer")
{
    in_browser("edges");
}

TEST_CASE("dash in a browser: exceptions, log and losses are shown") { in_browser("exceptions"); }

TEST_CASE("dash in a browser: a drone that died stays until it runs again or is stopped") { in_browser("crashes"); }

TEST_CASE("dash in a browser: the page survives drones and hivectl dash that are killed") { in_browser("restarts"); }

TEST_CASE("dash in a browser: two pages receive an output once, and closed ones not at all") { in_browser("shared"); }

TEST_CASE("dash in a browser: 24 outputs at once") { in_browser("many"); }

TEST_CASE("dash in a browser: 64 drones have the rate of each connection and the age of its events")
{
    in_browser("rates");
}

TEST_CASE("dash in a browser: advice names the bottleneck and has a command that is copied") { in_browser("advice"); }

TEST_CASE("dash in a browser: a source on demand waits until its image is asked for") { in_browser("demand"); }

TEST_CASE("dash in a browser: a stranger sees nothing, and another page changes nothing") { in_browser("strangers"); }

TEST_CASE("dash in a browser: the keyboard reaches each control, its focus is seen, and each has a label")
{
    in_browser("keyboard", "dash_people");
}

TEST_CASE("dash in a browser: two hivectl dash of one swarm change it") { in_browser("together", "dash_people"); }
