// The emulated camera is itself right: digests, parameters, streams.
#include "behaviour.hpp"
#include "login.hpp"
#include "md5.hpp"
#include "multipart.hpp"
#include "parameter_store.hpp"
#include "parameter_text.hpp"
#include "request.hpp"
#include "stream_text.hpp"

#include <doctest/doctest.h>

#include <stdexcept>

using namespace axis::emulator;

namespace {

const axis::Credentials owner{"root", "pass"};
constexpr LoginRules both{Policy::basic_digest, true, 0};
using Verdict = Login::Verdict;

std::string nonce_in(const std::string& challenge)
{
    const std::size_t begin = challenge.find("nonce=\"") + 7;
    return challenge.substr(begin, challenge.find('"', begin) - begin);
}

std::string digest(const axis::Credentials& who, const std::string& nonce, const std::string& uri, bool qop)
{
    const std::string common =
        "Digest username=\"" + who.user + "\", realm=\"AXIS_00408C\", nonce=\"" + nonce + "\", uri=\"" + uri + "\"";
    if (!qop)
        return common + ", response=\"" + digest_response(who, "AXIS_00408C", nonce, "GET", uri) + "\"";
    return common + ", cnonce=\"abc\", nc=00000001, qop=auth, response=\""
           + digest_response(who, "AXIS_00408C", nonce, "GET", uri, "00000001", "abc", "auth") + "\"";
}

}  // namespace

TEST_CASE("md5: the test suite of RFC 1321")
{
    CHECK(md5("") == "d41d8cd98f00b204e9800998ecf8427e");
    CHECK(md5("a") == "0cc175b9c0f1b6a831c399e269772661");
    CHECK(md5("abc") == "900150983cd24fb0d6963f7d28e17f72");
    CHECK(md5("message digest") == "f96b697d7cb7938d525a2f31aaf161d0");
    CHECK(md5("abcdefghijklmnopqrstuvwxyz") == "c3fcd3d76192e4007dfb496cca67e13b");
    CHECK(md5("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789") == "d174ab98d277d9f5a5611c2c9f419d9f");
    CHECK(md5("12345678901234567890123456789012345678901234567890123456789012345678901234567890")
          == "57edf4a22be3c955ac49da2e2107b67a");
}

TEST_CASE("digest: the example of RFC 2617, section 3.5")
{
    CHECK(digest_response({"Mufasa", "Circle Of Life"}, "testrealm@host.com", "dcd98b7102dd2f0e8b11d0f600bfb0c093",
                          "GET", "/dir/index.html", "00000001", "0a4f113b", "auth")
          == "6629fae49393a05397450978507c4ef1");
}

TEST_CASE("login: both schemes are offered, either is taken, wrong ones are not")
{
    Login login(owner, "00408C");
    CHECK(login.check(both, "GET", "/x", "") == Verdict::unknown);
    const auto challenges = login.challenges(both, Verdict::unknown);
    REQUIRE(challenges.size() == 2);
    CHECK(challenges[0].starts_with("Digest realm=\"AXIS_00408C\", nonce=\""));
    CHECK(challenges[1] == "Basic realm=\"AXIS_00408C\"");
    const std::string nonce = nonce_in(challenges[0]);
    for (const bool qop : {true, false}) {
        CHECK(login.check(both, "GET", "/x?y=1", digest(owner, nonce, "/x?y=1", qop)) == Verdict::welcome);
        CHECK(login.check(both, "GET", "/other", digest(owner, nonce, "/x", qop)) == Verdict::wrong);
        CHECK(login.check(both, "POST", "/x", digest(owner, nonce, "/x", qop)) == Verdict::wrong);
        CHECK(login.check(both, "GET", "/x", digest({"root", "wrong"}, nonce, "/x", qop)) == Verdict::wrong);
    }
    CHECK(login.check(both, "GET", "/x", "Basic cm9vdDpwYXNz") == Verdict::welcome);
    CHECK(login.check(both, "GET", "/x", "Basic cm9vdDpwYXN0") == Verdict::wrong);
    CHECK(login.check({Policy::digest, true, 0}, "GET", "/x", "Basic cm9vdDpwYXNz") == Verdict::unknown);
    CHECK(login.check({Policy::none, true, 0}, "GET", "/x", "") == Verdict::welcome);
}

TEST_CASE("login: a nonce that was used up, or another one, is stale, and the next challenge has a new one")
{
    Login login(owner, "00408C");
    const LoginRules rules{Policy::digest, false, 2};
    const std::string nonce = nonce_in(login.challenges(rules, Verdict::unknown)[0]);
    CHECK(login.check(rules, "GET", "/", digest(owner, nonce, "/", false)) == Verdict::welcome);
    CHECK(login.check(rules, "GET", "/", digest(owner, nonce, "/", false)) == Verdict::welcome);
    CHECK(login.check(rules, "GET", "/", digest(owner, nonce, "/", false)) == Verdict::stale);
    const auto challenge = login.challenges(rules, Verdict::stale)[0];
    CHECK(challenge.ends_with("stale=TRUE"));
    CHECK(nonce_in(challenge) != nonce);
    CHECK(login.check(rules, "GET", "/", digest(owner, nonce_in(challenge), "/", false)) == Verdict::welcome);
}

TEST_CASE("emulated parameters: groups are listed, unknown ones are an error among the others")
{
    const ParameterStore store("00408C");
    const auto list = axis::parse_parameters(store.list("root.Brand,Nowhere,ImageSource.I0.Sensor.Brightness"));
    CHECK(list.values.at("Brand.Brand") == "AXIS");
    CHECK(list.values.at("ImageSource.I0.Sensor.Brightness") == "50");
    CHECK(list.errors == std::vector<std::string>{"Error: Error -1 getting param in group 'Nowhere'"});
    CHECK(axis::parse_parameters(store.list("")).values.size() > 10);
    CHECK(axis::parse_parameters(store.list("Bran")).values.empty());
}

TEST_CASE("emulated parameters: an update sets what it can and names what it cannot")
{
    ParameterStore store("00408C");
    CHECK(store.update({{"root.ImageSource.I0.Sensor.Brightness", "63"}}, 1) == "OK\r\n");
    CHECK(store.number("ImageSource.I0.Sensor.Brightness") == 63);
    const auto refused = store.update({{"Image.I0.Appearance.Resolution", "9x9"},
                                       {"Image.I0.Appearance.Compression", "10"},
                                       {"Brand.Brand", "x"},
                                       {"No", "1"}},
                                      1);
    CHECK(axis::parse_parameters(refused).errors.size() == 3);
    CHECK(refused.starts_with("# Error: Error setting 'root.Image.I0.Appearance.Resolution' to '9x9'!"));
    CHECK(store.number("Image.I0.Appearance.Compression") == 10);
    CHECK(store.update({{"ImageSource.I0.Sensor.Brightness", "58"}}, 5) == "OK\r\n");
    CHECK(store.number("ImageSource.I0.Sensor.Brightness") == 55);
}

TEST_CASE("behaviour: words are set by name, mistakes are told with what there is")
{
    Behaviour behaviour;
    behaviour.set("stall_after", "7");
    behaviour.set("mute", "on");
    behaviour.set("auth", "digest");
    CHECK(behaviour.stall_after == 7);
    CHECK(behaviour.mute);
    CHECK(behaviour.login().policy == Policy::digest);
    CHECK(behaviour.text().find("stall_after=7\n") != std::string::npos);
    CHECK_THROWS_WITH_AS(behaviour.set("stal", "1"), doctest::Contains("stall_after"), std::invalid_argument);
    CHECK_THROWS_AS(behaviour.set("stall_after", "soon"), std::invalid_argument);
    CHECK_THROWS_AS(behaviour.set("mute", "yes"), std::invalid_argument);
    CHECK_THROWS_AS(behaviour.set("auth", "ntlm"), std::invalid_argument);
}

TEST_CASE("request: path, query and the fields that matter, in any case")
{
    const auto request = parse_request("GET /axis-cgi/param.cgi?action=update&A=x%20%26y HTTP/1.1\r\nHost: "
                                       "x\r\nAUTHORIZATION:  Basic abc\r\nContent-Length: 12\r\n\r\n");
    REQUIRE(request);
    CHECK(request->path == "/axis-cgi/param.cgi");
    CHECK(request->word("A") == "x &y");
    CHECK(request->word("none").empty());
    CHECK(request->authorization == "Basic abc");
    CHECK(request->body_size == 12);
    CHECK_FALSE(parse_request("nonsense\r\n\r\n"));
    CHECK_FALSE(parse_request("GET / FTP/1.0\r\n\r\n"));
    CHECK_FALSE(parse_request(""));
}

TEST_CASE("stream: the reader takes every boundary, line end and length that still says where a picture ends")
{
    const std::string jpeg = "\xFF\xD8 picture \r\n\r\n \xFF\xD9";
    for (const char* boundary : {"plain", "dashed", "quoted", "tight"})
        for (const char* line_end : {"crlf", "lf"})
            for (const char* length : {"right", "missing", "text"})
                for (const char* garbage : {"off", "on"}) {
                    const std::string variant = std::string(boundary) + " " + line_end + " " + length + " " + garbage;
                    CAPTURE(variant);
                    Behaviour behaviour;
                    behaviour.set("boundary", boundary);
                    behaviour.set("line_end", line_end);
                    behaviour.set("length", length);
                    behaviour.set("garbage", std::string(length) == "right" ? garbage : "off");
                    const auto name = axis::boundary_of(stream_type(behaviour));
                    REQUIRE(name);
                    axis::MultipartReader reader(*name);
                    reader.feed(stream_part(behaviour, jpeg) + stream_part(behaviour, jpeg)
                                + stream_part(behaviour, jpeg));
                    for (int i = 0; i < 2; ++i) {
                        const auto part = reader.next();
                        REQUIRE(part);
                        CHECK(part->bytes == jpeg);
                        CHECK(part->type == "image/jpeg");
                    }
                }
}
