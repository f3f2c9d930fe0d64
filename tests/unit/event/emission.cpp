// Events as packets and back.
#include "fixtures.hpp"

#include <hive/error.hpp>

#include <doctest/doctest.h>

namespace hive::event {

using protocol::PacketType;

TEST_CASE("emission: what is sent is what arrives")
{
    Event event = emission(42, true)->event();
    event.identity.captured_us = 1'700'000'000'000'000;
    event.identity.monotonic_us = 123;
    event.identity.part = 3;
    event.identity.hops = {{"face", 10, 20}};
    event.header = {{"faces", {1, 2}}};
    const Emission sent(event);
    const Event back = event_from_packet(sent.packet(PacketType::event, 9));
    CHECK(back.identity.source == "camera");
    CHECK(back.identity.sequence == 42);
    CHECK(back.identity.lossless);
    CHECK(back.identity.captured_us == event.identity.captured_us);
    CHECK(back.identity.part == 3);
    REQUIRE(back.identity.hops.size() == 1);
    CHECK(back.identity.hops[0].work_us == 20);
    CHECK(back.header == event.header);
    CHECK(back.size == 10);
    CHECK(back.body.data() == event.body.data());  // shared, not copied
}

TEST_CASE("emission: how far the clock of the source is away travels with its time, and the age is without it")
{
    Event event = emission(1)->event();
    for (const std::int64_t offset_us : {std::int64_t{3'600'000'000}, std::int64_t{-3'600'000'000}, std::int64_t{0}}) {
        event.identity.captured_us = wall_us() + offset_us;
        event.identity.offset_us = offset_us;
        const Event back = event_from_packet(Emission(event).packet(PacketType::event, 1));
        CHECK(back.identity.offset_us == offset_us);
        CHECK(back.identity.captured_us == event.identity.captured_us);
        CHECK(back.age() >= std::chrono::seconds(0));
        CHECK(back.age() < std::chrono::minutes(1));
    }
}

TEST_CASE("emission: the header is encoded once for all receivers")
{
    const auto sent = emission(1);
    CHECK(sent->packet(PacketType::event, 1).header == sent->packet(PacketType::event, 2).header);
}

TEST_CASE("emission: a notification has the size of the body and no body")
{
    const auto packet = emission(1)->packet(PacketType::notification, 1);
    CHECK(packet.body.empty());
    CHECK(event_from_packet(packet).size == 10);
}

TEST_CASE("emission: the share of the receiver travels in the header, and on to the results")
{
    const Share given{.of = "camera.image#workers", .epoch = 1, .turn = 17, .attempt = 3, .closed = 12};
    const Event shared = event_from_packet(emission(1)->packet(PacketType::event, 1, given));
    REQUIRE(shared.identity.shares.size() == 1);
    CHECK(shared.identity.shares[0] == given);
    const Event result = event_from_packet(Emission(shared).packet(PacketType::event, 1));
    CHECK(result.identity.shares == shared.identity.shares);
    CHECK(event_from_packet(emission(1)->packet(PacketType::event, 1)).identity.shares.empty());
}

TEST_CASE("emission: stages nest, outermost first, and the outermost group is whose work it is")
{
    const Share outer{.of = "camera.image#faces", .epoch = 1, .turn = 4, .part = 2, .to = "image"};
    const Share middle{.of = "face.crops", .epoch = 2, .turn = 9},
        inner{.of = "face.crops#ages", .epoch = 2, .turn = 1};
    Event event = emission(1)->event();
    event.identity.shares = {middle, outer};
    const Event nested = event_from_packet(Emission(event).packet(PacketType::event, 1, inner));
    CHECK(nested.identity.shares == std::vector<Share>{middle, outer, inner});
    REQUIRE(nested.identity.shared_work());
    CHECK(*nested.identity.shared_work() == outer);
    event.identity.shares = {middle};
    CHECK_FALSE(event.identity.shared_work());
}

TEST_CASE("emission: plain receivers of a lossless event are told its own share, others the one they are given")
{
    const auto sent = emission(6, true);
    const auto told = [&](const std::optional<Share>& share) {
        return event_from_packet(sent->packet(PacketType::event, 1, share)).identity.shares;
    };
    CHECK(told({}) == std::vector<Share>{{.of = "camera.image", .epoch = 1, .turn = 6}});
    const Share again{.of = "camera.image", .epoch = 1, .turn = 6, .attempt = 2};
    CHECK(told(again) == std::vector<Share>{again});
}

TEST_CASE("emission: an event that has gone through 16 shared stages goes no further")
{
    Event event = emission(1)->event();
    event.identity.shares.assign(15, {.of = "camera.image#workers", .epoch = 1, .turn = 1});
    CHECK_NOTHROW(Emission{event});
    event.identity.shares.push_back(event.identity.shares.front());
    CHECK_THROWS_AS(Emission{event}, Error);
}

TEST_CASE("emission: a header over the limit is refused where it is made")
{
    Event event = emission(1)->event();
    event.header = {{"text", std::string(15'000, 'x')},
                    {"more", std::string(15'000, 'y')},
                    {"and", std::string(15'000, 'z')},
                    {"so", std::string(15'000, 'a')},
                    {"on", std::string(15'000, 'b')}};
    CHECK_THROWS_AS(Emission{event}, Error);
}

TEST_CASE("emission: a header that no receiver would read is refused where it is made")
{
    const auto refused = [](Json header) {
        Event event = emission(1)->event();
        event.header = std::move(header);
        try {
            const Emission sent(std::move(event));
        } catch (const hive::Error& error) {
            return error.code() == hive::Errc::too_large;
        }
        return false;
    };
    const auto nested = [](int levels) {
        Json value = 1;
        for (int i = 0; i < levels; ++i)
            value = Json{{"a", value}};
        return value;
    };
    CHECK_FALSE(refused(nested(15)));
    CHECK(refused(nested(16)));
    CHECK_FALSE(refused({{"text", std::string(16384, 'x')}}));
    CHECK(refused({{"text", std::string(16385, 'x')}}));
    CHECK(refused({{std::string(16385, 'x'), 1}}));
    Json wide = Json::object();
    for (int i = 0; i < 256; ++i)
        wide["k" + std::to_string(i)] = i;
    CHECK_FALSE(refused(wide));
    wide["one more"] = 1;
    CHECK(refused(wide));
}

TEST_CASE("emission: a packet with a wrong header is malformed")
{
    for (const char* header : {"{}", "[]", "{\"source\":\"a b\"}", "{\"source\":\"camera\",\"epoch\":-1}"})
        CHECK_THROWS_AS(event_from_packet(protocol::make_packet(PacketType::event, header)), Error);
}

namespace {

/// What a header is read as: the event written again, or the code of the refusal.
std::string outcome(const std::string& header)
{
    try {
        const auto event = event_from_packet(
            {PacketType::event, 1, std::make_shared<const std::string>(header), emission(1)->event().body});
        return std::string(Emission(event).packet(PacketType::event, 1).header_text()) + std::to_string(event.size);
    } catch (const Error& error) {
        return std::string(info(error.code()).token);
    }
}

/// White space before it is allowed, and leaves a header to the reader of all JSON.
std::string outcome_in_general(const std::string& header) { return outcome(' ' + header); }

std::string full_header()
{
    Event event = emission(42, true)->event();
    event.identity.captured_us = 1'700'000'000'000'000;
    event.identity.part = 3;
    event.identity.hops = {{"face", 10, 20}, {"blur", 0, 7}};
    event.header = {{"faces", {1, -2.5, "a \"quoted\" {"}}, {"more", {{"deep", {{}, nullptr, true}}}}};
    return std::string(Emission(event)
                           .packet(PacketType::event, 1,
                                   Share{.of = "camera.image#workers",
                                         .epoch = 5,
                                         .turn = 17,
                                         .attempt = 3,
                                         .closed = 9,
                                         .part = 1,
                                         .to = "image"})
                           .header_text());
}

std::string repeated(const std::string& text, std::size_t times)
{
    std::string all;
    while (times-- > 0)
        all += text;
    return all;
}

}  // namespace

TEST_CASE(
    "emission: a header is read the same directly and as JSON, whichever byte of it is changed, left out or doubled")
{
    const std::string header = full_header();
    REQUIRE(outcome(header) == header + "10");
    const std::string bytes = std::string("\"\\{}[],:0-19.eE tn\x7f\xc3") + '\0';
    for (std::size_t i = 0; i < header.size(); ++i) {
        std::vector<std::string> changed{header.substr(0, i) + header.substr(i + 1),
                                         header.substr(0, i) + header.substr(i), header.substr(0, i)};
        changed[1].insert(i, 1, header[i]);
        for (const char byte : bytes)
            (changed.emplace_back(header))[i] = byte;
        for (const auto& text : changed)
            if (outcome(text) != outcome_in_general(text))
                FAIL_CHECK(text << " is read as " << outcome(text) << ", and in general as "
                                << outcome_in_general(text));
    }
}

TEST_CASE("emission: the limits of a header are the same, directly and as JSON")
{
    const std::string hop = R"({"drone":"face","wait_us":1,"work_us":2})";
    const std::string header = R"({"sender":"a","kind":"a","output":"a","type":"a/b","source":"a","epoch":1,"seq":1)";
    const std::string share = R"({"of":"camera.image#workers","epoch":1,)";
    const auto shares = [](const std::string& list) { return R"(,"shares":[)" + list + "]}"; };
    const std::pair<std::string, std::string> expected[]{
        {header + shares(share + R"("turn":9007199254740992})"), ""},
        {header + shares(share + R"("turn":9007199254740993})"), "malformed"},
        {header + shares(share + R"("turn":01})"), "malformed"},
        {header + shares(share + R"("turn":1,"attempt":1048576})"), ""},
        {header + shares(share + R"("turn":1,"attempt":1048577})"), "malformed"},
        {header + shares(R"({"of":"camera","epoch":1,"turn":1})"), "malformed"},
        {header + shares(R"({"of":"camera.image#","epoch":1,"turn":1})"), "malformed"},
        {header + shares(R"({"of":"camera.image","turn":1})"), "malformed"},
        {header + shares(repeated(share + R"("turn":1},)", 15) + share + R"("turn":1})"), "refused"},
        {header + shares(repeated(share + R"("turn":1},)", 16) + share + R"("turn":1})"), "malformed"},
        {header + R"(,"seq":1})", "malformed"},
        {header + R"(,"unknown":{"a":[1]}})", ""},
        {header + R"(,"hops":[]})", ""},
        {header + R"(,"hops":[)" + repeated(hop + ",", 15) + hop + "]}", ""},
        {header + R"(,"hops":[)" + repeated(hop + ",", 16) + hop + "]}", "malformed"},
        {header + R"(,"header":{"a":)" + repeated("[", 14) + repeated("]", 14) + "}}", ""},
        {header + R"(,"header":{"a":)" + repeated("[", 15) + repeated("]", 15) + "}}", "too_large"},
        {header + R"(,"header":{"a":1,"a":2}})", "malformed"},
        {header + R"(,"header":[]})", "malformed"},
        {header.substr(0, header.size() - 8) + "}", "malformed"},
        {R"({"sender":"a b")" + header.substr(13) + "}", "malformed"},
    };
    for (const auto& [text, code] : expected) {
        CAPTURE(text);
        CHECK(outcome(text) == outcome_in_general(text));
        CHECK((code.empty() ? outcome(text).front() == '{' : outcome(text) == code));
    }
}

TEST_CASE("emission: text that is not plain is escaped, and bytes that are no UTF-8 are replaced")
{
    Event event = emission(1)->event();
    event.type = "a/\"b\\\n\xff";
    CHECK(event_from_packet(Emission(event).packet(PacketType::event, 1)).type == "a/\"b\\\n\xEF\xBF\xBD");
}

TEST_CASE("emission: a notification of a body that nobody wanted to be made tells no size, and 0 is a size")
{
    Event event = emission(1)->event();
    event.body = {};
    event.size = 0;
    const auto unknown = Emission(event, false).packet(PacketType::notification, 1);
    CHECK(unknown.header_text().find("\"size\"") == std::string_view::npos);
    CHECK_FALSE(event_from_packet(unknown).sized);
    const auto empty = Emission(event, true).packet(PacketType::notification, 1);
    CHECK(empty.header_text().find("\"size\":0") != std::string_view::npos);
    CHECK(event_from_packet(empty).sized);
    event.size = 12;  // of a recording that kept the header alone
    CHECK(event_from_packet(Emission(event, false).packet(PacketType::notification, 1)).size == 12);
    CHECK(event_from_packet(protocol::make_packet(PacketType::event, std::string(unknown.header_text()), 1)).sized);
}

}  // namespace hive::event
