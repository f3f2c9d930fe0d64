// Which encoding a receiver gets: asked for, by the way to it, by what it takes.
#include "fixtures.hpp"

#include <hive/error.hpp>
#include <hive/event/encoding_choice.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

using Way = EncodingChoice::Way;

const Port pictures{.name = "image",
                    .type = "image/*",
                    .help = "",
                    .encodings = {{"jpeg", "image/jpeg", 1, 100}, {"png", "image/png"}, {"raw", "image/raw"}}};

protocol::Registration registration(const std::string& encoding = {}, const std::string& accepts = "image/*")
{
    protocol::Registration result{.id = 1,
                                  .epoch = 1,
                                  .output = "image",
                                  .receiver = "face.image",
                                  .accepts = accepts,
                                  .options = {},
                                  .taken = {}};
    result.options.encoding = encoding;
    return result;
}

Event event_of(const std::string& type)
{
    Event event = emission(1)->event();
    event.type = type;
    return event;
}

std::string chosen(const protocol::Registration& asked, Way way, const std::string& type)
{
    return EncodingChoice(pictures, asked, way).of(event_of(type));
}

Errc refusal(const Port& output, const protocol::Registration& asked)
{
    try {
        EncodingChoice(output, asked, Way::one_machine);
    } catch (const Error& error) {
        return error.code();
    }
    return Errc::io;
}

}  // namespace

TEST_CASE("encoding: by itself, as it is on one machine and the preferred one across a network")
{
    CHECK(chosen(registration(), Way::one_machine, "image/raw") == "");
    CHECK(chosen(registration(), Way::one_machine, "image/png") == "");
    CHECK(chosen(registration(), Way::network, "image/raw") == "jpeg");
    CHECK(EncodingChoice(pictures, registration(), Way::one_machine).word() == "as it is");
    CHECK(EncodingChoice(pictures, registration(), Way::network).word() == "jpeg");
}

TEST_CASE("encoding: a word without a number is met by every body of its type, a number never is")
{
    CHECK(chosen(registration("jpeg"), Way::one_machine, "image/jpeg") == "");
    CHECK(chosen(registration(), Way::network, "image/jpeg") == "");
    CHECK(chosen(registration("jpeg:60"), Way::one_machine, "image/jpeg") == "jpeg:60");
    CHECK(chosen(registration("raw"), Way::network, "image/raw") == "");
    CHECK(chosen(registration("raw"), Way::network, "image/jpeg") == "raw");
}

TEST_CASE("encoding: what the receiver does not take as it is comes in one that it takes, and is called by that name")
{
    CHECK(chosen(registration("", "image/jpeg"), Way::one_machine, "image/raw") == "jpeg");
    CHECK(chosen(registration("", "image/raw"), Way::one_machine, "image/jpeg") == "raw");
    CHECK(chosen(registration("", "image/png,image/raw"), Way::network, "image/jpeg") == "png");
    CHECK(chosen(registration("", "text/plain"), Way::network, "image/jpeg") == "");
    EncodingChoice choice(pictures, registration("", "image/jpeg"), Way::one_machine);
    choice.of(event_of("image/raw"));
    CHECK(choice.word() == "jpeg");
    choice.of(event_of("image/jpeg"));
    CHECK(choice.word() == "as it is");
}

TEST_CASE("encoding: without a body there is nothing to encode, and notifications are of the event as it was emitted")
{
    Event empty = event_of("image/raw");
    empty.body = {};
    CHECK(EncodingChoice(pictures, registration("jpeg:60"), Way::network).of(empty) == "");
    auto notified = registration();
    notified.options.delivery = Delivery::notification;
    CHECK(EncodingChoice(pictures, notified, Way::network).word() == "as it is");
}

TEST_CASE("encoding: what the output does not know or the receiver does not take is refused")
{
    CHECK(refusal(pictures, registration("webp")) == Errc::invalid_argument);
    CHECK(refusal({}, registration("jpeg")) == Errc::invalid_argument);
    CHECK(refusal(pictures, registration("png", "image/jpeg")) == Errc::type_mismatch);
    CHECK(refusal({}, registration()) == Errc::io);  // nothing asked for, nothing refused
}

TEST_CASE("encoding: an output without an encoder sends everything as it is, whatever the way")
{
    const Port none;
    EncodingChoice choice(none, registration("", "*/*"), Way::network);
    CHECK(choice.of(event_of("image/raw")) == "");
    CHECK(choice.word() == "as it is");
}

}  // namespace hive::event
