// Tokens, connection options, and messages through text.
#include <hive/error.hpp>
#include <hive/protocol/messages.hpp>
#include <hive/transfer.hpp>

#include <doctest/doctest.h>

using namespace hive;
using namespace std::chrono_literals;

TEST_CASE("tokens: each word gives its enumerator and back")
{
    for (const auto value : {State::starting, State::idle, State::busy, State::halted, State::stopping})
        CHECK_EQ(from_token<State>(token(value), "state"), value);
    for (const auto value : {ExceptionPolicy::skip, ExceptionPolicy::halt})
        CHECK_EQ(from_token<ExceptionPolicy>(token(value), "policy"), value);
    CHECK_THROWS_WITH_AS(from_token<Transfer>("fast", "transfer"), "transfer must be one of sync, stream, not \"fast\"",
                         Error);
}

TEST_CASE("options: defaults are the paper's synchronized transfer of one event at a time")
{
    CHECK(connection_options(Json::object()) == ConnectionOptions{});
    CHECK_EQ(to_json(ConnectionOptions{}), Json::parse(R"({"transfer":"sync","delivery":"data","window":1})"));
}

TEST_CASE("options: every field survives the way")
{
    const ConnectionOptions shared{.transfer = Transfer::synchronized,
                                   .delivery = Delivery::data,
                                   .window = 64,
                                   .group = "workers",
                                   .lease = 2500ms,
                                   .encoding = "jpeg:80"};
    ConnectionOptions watching;
    watching.transfer = Transfer::streaming;
    watching.delivery = Delivery::notification;
    watching.first_frame = true;
    for (const auto& options : {shared, watching})
        CHECK(connection_options(parse_json(to_text(to_json(options)))) == options);
}

TEST_CASE("options: what conflicts with a group is refused with both named")
{
    for (const char* option : {R"("transfer":"stream")", R"("delivery":"notify")", R"("first_frame":true)"})
        CHECK_THROWS_AS(connection_options(parse_json(R"({"group":"workers",)" + std::string(option) + "}")), Error);
    CHECK_THROWS_WITH_AS(connection_options(parse_json(R"({"group":"workers","first_frame":true})")),
                         "a group gives each event to one member: first_frame, which starts with an event that others "
                         "may have had, conflicts with it",
                         Error);
}

TEST_CASE("encoding: a word in lower case, with a number if wanted")
{
    for (const char* text : {"raw", "jpeg:80", "h264", "x-y:000001"})
        CHECK_MESSAGE(is_encoding(text), text);
    for (const char* text : {"", ":", "jpeg:", ":80", "Jpeg", "jpeg:80:1", "jpeg:-1", "jpeg: 80", "1x", "-x",
                             "image/jpeg", "jpeg:1234567", "\xC3\xA9"})
        CHECK_FALSE_MESSAGE(is_encoding(text), text);
}

TEST_CASE("registration: every field survives the way")
{
    protocol::Registration registration{.id = 3,
                                        .epoch = max_json_integer,
                                        .output = "image",
                                        .receiver = "face.image",
                                        .accepts = "image/*",
                                        .stateful = true,
                                        .options = {},
                                        .place = 17,
                                        .taken = 0,
                                        .held = 2,
                                        .tried = 5};
    registration.options.window = 4;
    const auto read = protocol::registration_from_json(parse_json(to_text(to_json(registration))));
    CHECK_EQ(to_json(read), to_json(registration));
    CHECK_EQ(read.options.window, 4);
    CHECK_EQ(read.place, 17);
    CHECK_EQ(read.taken, 0);
    CHECK_EQ(read.held, 2);
    CHECK_EQ(read.tried, 5);
    registration.taken.reset();
    CHECK_FALSE(protocol::registration_from_json(to_json(registration)).taken);
}

TEST_CASE("request: every field survives the way")
{
    const protocol::Request request{.epoch = 1, .id = 9, .done = 3, .worked = 5, .back = {7, 8}};
    const auto read = protocol::request_from_json(parse_json(protocol::to_text(request)));
    CHECK_EQ(read.epoch, 1);
    CHECK_EQ(read.id, 9);
    CHECK_EQ(read.done, 3);
    CHECK_EQ(read.worked, 5);
    CHECK(read.back == request.back);
}

TEST_CASE("request: its text is read alike whether it is written as Hive writes it or as others may")
{
    for (const std::string text :
         {R"({"epoch":1,"id":9,"done":3})", R"({"epoch":1,"id":9,"done":3,"worked":5})",
          R"({ "id": 9, "done": 3, "epoch": 1 })", R"({"epoch":1,"id":9})", R"({"epoch":1,"id":9,"done":3,"more":{}})",
          R"({"epoch":1,"id":9,"done":3,"worked":5,"back":[7]})"}) {
        const auto quick = protocol::request_from_text(text), slow = protocol::request_from_json(parse_json(text));
        CHECK_EQ(protocol::to_text(quick), protocol::to_text(slow));
        CHECK_EQ(quick.id, 9);
    }
    for (const std::string text :
         {R"({"epoch":1,"id":-9,"done":3})", R"({"epoch":1,"id":09,"done":3})", R"({"epoch":1,"id":9,"done":3)",
          R"({"epoch":1,"id":9,"done":3}})", R"({"epoch":1,"id":9,"done":99999999999999999})"})
        CHECK_THROWS_AS(protocol::request_from_text(text), Error);
}

TEST_CASE("confirmation: every error code survives the way")
{
    for (int i = 0; i <= static_cast<int>(Errc::io); ++i) {
        const protocol::Confirmation refused{
            .id = 1, .result = {}, .ok = false, .code = static_cast<Errc>(i), .text = "why"};
        const auto read = protocol::confirmation_from_json(parse_json(to_text(to_json(refused))));
        CHECK_FALSE(read.ok);
        CHECK_EQ(read.code, refused.code);
        CHECK_EQ(read.text, "why");
    }
}

TEST_CASE("confirmation: no result is an empty one")
{
    CHECK_EQ(to_text(to_json(protocol::Confirmation{.id = 1, .result = {}, .ok = true, .code = {}, .text = {}})),
             R"({"id":1,"result":{}})");
}
