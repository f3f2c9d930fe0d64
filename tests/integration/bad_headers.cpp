// Headers that are malformed in every way, on packets that are otherwise right: each is refused or ends its own
// connection.
#include "prey.hpp"

#include <doctest/doctest.h>

using namespace hostile;

namespace {

std::string nested(int depth, const std::string& open, const std::string& close)
{
    std::string text;
    for (int i = 0; i < depth; ++i)
        text += open;
    for (int i = 0; i < depth; ++i)
        text += close;
    return text;
}

std::string many_keys(int count)
{
    std::string text;
    for (int i = 0; i < count; ++i)
        text += ",\"k" + std::to_string(i) + "\":0";
    return text;
}

/// What is not JSON as section 3 allows it, or has no valid id: ends the connection.
std::vector<std::string> headers_that_close()
{
    const std::string nul("\0", 1);
    return {
        "",
        " ",
        "null",
        "1",
        "\"id\"",
        "[]",
        "[1]",
        "{",
        "}",
        "{}",
        "{\"id\":1",
        "{\"id\":1}}",
        "{\"id\":1}x",
        "{\"id\":1,}",
        "{id:1}",
        "{'id':1}",
        "{\"id\":1}" + nul,
        nul,
        "{\"id\":1,\"a\":\"" + nul + "\"}",
        "\xEF\xBB\xBF{\"id\":1}",
        "{\"id\":1,\"id\":2}",
        "{\"id\":1,\"i\\u0064\":2}",
        "{\"id\":1,\"a\":{\"b\":1,\"b\":1}}",
        "{\"id\":1,\"a\":\"\xFF\"}",
        "{\"id\":1,\"a\":\"\xC0\x80\"}",
        "{\"id\":1,\"a\":\"\xED\xA0\x80\"}",
        "{\"id\":1,\"a\":\"\xF4\x90\x80\x80\"}",
        "{\"id\":1,\"\xC3\":1}",
        "{\"id\":1,\"a\":\"\\ud800\"}",
        "{\"id\":1,\"a\":\"\\udc00\"}",
        "{\"id\":1,\"a\":\"\\ud800\\ud800\"}",
        "{\"id\":1,\"a\":\"\\x41\"}",
        "{\"id\":1,\"a\":1e400}",
        "{\"id\":1,\"a\":-1e400}",
        "{\"id\":1,\"a\":18446744073709551616}",
        "{\"id\":1,\"a\":-9223372036854775809}",
        "{\"id\":1,\"a\":01}",
        "{\"id\":1,\"a\":+1}",
        "{\"id\":1,\"a\":.5}",
        "{\"id\":1,\"a\":NaN}",
        "{\"id\":1,\"a\":Infinity}",
        "{\"id\":1,\"a\":" + nested(16, "[", "]") + "}",
        "{\"id\":1,\"a\":" + nested(30000, "[", "]") + "}",
        nested(10000, "{\"a\":", "}"),
        "{\"id\":1" + many_keys(256) + "}",
        "{\"id\":1,\"a\":\"" + std::string(16385, 'x') + "\"}",
        "{\"id\":1,\"" + std::string(16385, 'k') + "\":1}",
        "{\"id\":-1}",
        "{\"id\":1.0}",
        "{\"id\":1e3}",
        "{\"id\":\"1\"}",
        "{\"id\":null}",
        "{\"id\":true}",
        "{\"id\":[1]}",
        "{\"id\":9007199254740993}",
    };
}

/// Right as JSON, and with an id: answered, whatever with.
std::vector<std::string> headers_that_are_answered()
{
    return {
        R"({"id":1})",
        R"( {"id" : 1} )",
        R"({"id":1,"unknown":{"deep":[1,{"er":null}]}})",
        "{\"id\":1" + many_keys(255) + "}",
        "{\"id\":1,\"a\":" + nested(15, "[", "]") + "}",
        "{\"id\":1,\"a\":\"" + std::string(16384, 'x') + "\"}",
        R"({"id":1,"a":"\u0000"})",
        R"({"id":1,"a":"\ud83d\ude00"})",
        R"({"id":1,"a":18446744073709551615,"b":1e308,"c":-0.0})",
    };
}

Json registration(Json changed)
{
    Json json{{"id", 1}, {"epoch", 1}, {"output", "image"}, {"receiver", "raw"}, {"options", Json::object()}};
    json.update(changed);
    return json;
}

}  // namespace

TEST_CASE("hostile header: what is not valid ends its connection and nothing else")
{
    const Prey prey = Prey::camera();
    const Witness witness(prey);
    for (const int type : {int(raw::describe), int(raw::register_)})
        for (const auto& header : headers_that_close()) {
            CAPTURE(header.substr(0, 100));
            auto peer = prey.meet();
            peer.send(raw::packet(type, type == raw::register_ ? 1 : 0, header));
            CHECK(peer.closed_within(within(500)));
        }
    MESSAGE(headers_that_close().size() << " headers");
    CHECK(prey.well());
    CHECK(witness.lost() == 0);
    CHECK_FALSE(witness.cut_off());
}

TEST_CASE("hostile header: what is odd but valid is answered; unknown fields are ignored")
{
    const Prey prey = Prey::camera();
    auto peer = prey.meet();
    for (const auto& header : headers_that_are_answered()) {
        CAPTURE(header.substr(0, 100));
        REQUIRE(peer.send(raw::packet(raw::status, 0, header)));
        const auto answer = peer.next_of(raw::confirmation, within(1000));
        REQUIRE(answer);
        CHECK(raw::error_of(answer->json()) == "");
    }
}

TEST_CASE("hostile header: a registration with a wrong field is answered and registers nothing")
{
    const Prey prey = Prey::camera();
    auto peer = prey.meet();
    const std::vector<Json> wrong{{{"epoch", -1}},
                                  {{"epoch", 1.5}},
                                  {{"epoch", "1"}},
                                  {{"output", ""}},
                                  {{"output", "../image"}},
                                  {{"output", 1}},
                                  {{"receiver", "a b"}},
                                  {{"receiver", "a.b/c"}},
                                  {{"accepts", 1}},
                                  {{"stateful", "no"}},
                                  {{"options", 1}},
                                  {{"options", {{"window", -1}}}},
                                  {{"options", {{"window", 1000000000}}}},
                                  {{"options", {{"window", "1"}}}},
                                  {{"options", {{"transfer", "SYNC"}}}},
                                  {{"options", {{"transfer", 1}}}},
                                  {{"options", {{"delivery", "all"}}}},
                                  {{"options", {{"group", "../g"}}}},
                                  {{"options", {{"first_frame", 1}}}},
                                  {{"options", {{"lease_ms", 49}}}},
                                  {{"options", {{"lease_ms", 1e18}}}}};
    for (const auto& each : wrong) {
        CAPTURE(each);
        CHECK(raw::error_of(peer.ask(raw::register_, registration(each), 1)) == "malformed");
    }
    for (const Json outputs = peer.ask(raw::status).at("result").at("outputs"); const auto& output : outputs)
        CHECK(output.at("edges") == Json::array());
    CHECK(raw::error_of(peer.ask(raw::register_, registration(Json::object()), 1)) == "");
}

TEST_CASE("hostile header: a request for a billion gets one event at a time, and requests of old epochs and unknown "
          "channels nothing")
{
    const Prey prey = Prey::camera();
    auto peer = prey.meet();
    REQUIRE(raw::error_of(peer.ask(raw::register_, registration({{"epoch", 5}}), 3)) == "");
    REQUIRE(peer.next_of(raw::event, within(2000)));
    for (const char* ignored : {R"({"epoch":4,"id":1000000000})", R"({"epoch":6,"id":1000000000,"done":1000000000})",
                                R"({"epoch":5,"id":0,"done":0})"})
        REQUIRE(peer.send(raw::packet(raw::request, 3, ignored)));
    REQUIRE(peer.send(raw::packet(raw::request, 4, R"({"epoch":5,"id":1000000000})")));
    REQUIRE(peer.send(raw::packet(raw::request, 0, R"({"epoch":5,"id":1000000000})")));
    CHECK_FALSE(peer.next_of(raw::event, Milliseconds(300)));
    REQUIRE(peer.send(raw::packet(raw::request, 3, R"({"epoch":5,"id":1000000000,"done":1000000000})")));
    CHECK(peer.next_of(raw::event, within(1000)));
    CHECK_FALSE(peer.next_of(raw::event, Milliseconds(300)));
    const Json rows = peer.ask(raw::status).at("result").at("outputs").at(0).at("edges");
    REQUIRE(rows.size() == 1);
    CHECK(rows[0].at("acknowledged") == 1);  // nobody has dealt with what it was not sent yet
}

TEST_CASE("hostile header: a request with a wrong field ends the connection")
{
    const Prey prey = Prey::camera();
    for (const char* header :
         {R"({"epoch":1})", R"({"id":2})", R"({"epoch":1,"id":-2})", R"({"epoch":1,"id":2,"done":-1})",
          R"({"epoch":1,"id":2.5})", R"({"epoch":"1","id":2})"}) {
        auto peer = prey.meet();
        REQUIRE(raw::error_of(peer.ask(raw::register_, registration(Json::object()), 1)) == "");
        peer.send(raw::packet(raw::request, 1, header));
        CHECK_MESSAGE(peer.closed_within(within(500)), header);
    }
    CHECK(prey.well());
}
