// The queue between the network side and the user thread.
#include <hive/event/mailbox.hpp>
#include <hive/event/ticket.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

Event numbered(std::int64_t sequence, bool lossless = false, std::size_t bytes = 0)
{
    Event event;
    event.identity.sequence = sequence;
    event.identity.lossless = lossless;
    event.body = Body(std::vector<unsigned char>(bytes));
    return event;
}

std::int64_t next_sequence(Mailbox& mailbox)
{
    auto item = mailbox.pop();
    return item && std::holds_alternative<Event>(*item) ? std::get<Event>(*item).identity.sequence : -1;
}

}  // namespace

TEST_CASE("mailbox: commands overtake events, and events keep their order")
{
    Mailbox mailbox;
    int commands = 0;
    mailbox.push(numbered(1));
    mailbox.push(numbered(2));
    mailbox.push([&] { ++commands; });
    auto first = mailbox.pop();
    REQUIRE(first);
    std::get<Mailbox::Command> (*first)();
    CHECK(commands == 1);
    CHECK(next_sequence(mailbox) == 1);
    CHECK(next_sequence(mailbox) == 2);
    CHECK_FALSE(mailbox.pop());
}

TEST_CASE("mailbox: a halted drone is given commands only")
{
    Mailbox mailbox;
    mailbox.push(numbered(1));
    CHECK_FALSE(mailbox.pop(false));
    CHECK(mailbox.events() == 1);
}

TEST_CASE("mailbox: over its bounds the oldest event that may be lost goes")
{
    Mailbox mailbox;
    mailbox.push(numbered(0, true));
    for (std::size_t i = 1; i <= Mailbox::most_events + 4; ++i)
        mailbox.push(numbered(static_cast<std::int64_t>(i)));
    CHECK(mailbox.events() == Mailbox::most_events);
    CHECK(next_sequence(mailbox) == 0);
    CHECK(next_sequence(mailbox) == 6);
}

TEST_CASE("mailbox: large events are bounded by their bytes")
{
    Mailbox mailbox;
    for (int i = 0; i < 6; ++i)
        mailbox.push(numbered(i, false, Mailbox::most_bytes / 3));
    CHECK(mailbox.events() == 3);
    CHECK(next_sequence(mailbox) == 3);
}

TEST_CASE("mailbox: over its bounds an output that floods it loses its own events, and no other output does")
{
    const auto from = [](const char* sender, std::int64_t sequence, std::size_t bytes = 0) {
        auto event = numbered(sequence, false, bytes);
        event.sender = sender;
        event.output = "image";
        return event;
    };
    const auto few_left = [](Mailbox& mailbox) {
        return mailbox.count([](const Event& event) { return event.sender == "few"; });
    };
    Mailbox by_number, by_bytes;
    for (auto* mailbox : {&by_number, &by_bytes})
        for (int i = 0; i < 20; ++i)
            mailbox->push(from("few", i));
    for (std::size_t i = 0; i < 2 * Mailbox::most_events; ++i)
        by_number.push(from("flood", 0));
    CHECK(few_left(by_number) == 20);
    CHECK(by_number.events() == Mailbox::most_events);
    for (int i = 0; i < 20; ++i)
        by_bytes.push(from("flood", 100 + i, Mailbox::most_bytes / 4));
    CHECK(few_left(by_bytes) == 20);
    CHECK(by_bytes.events() == 24);
    by_bytes.discard([](const Event& event) { return event.sender == "few"; });
    CHECK(next_sequence(by_bytes) == 116);
}

TEST_CASE("mailbox: lossless events are bounded by what their sender may have in hand, and none is dropped")
{
    Mailbox mailbox;
    for (std::size_t i = 0; i < Mailbox::most_events + 4; ++i)
        mailbox.push(numbered(static_cast<std::int64_t>(i), true));
    CHECK(mailbox.events() == Mailbox::most_events + 4);
    CHECK(next_sequence(mailbox) == 0);
}

TEST_CASE("mailbox: what was dropped or discarded gives back its ticket at once")
{
    Mailbox mailbox;
    auto event = numbered(1);
    const auto owed = std::make_shared<Acknowledgement>();
    event.ticket = {owed, true};
    mailbox.push(std::move(event));
    for (std::size_t i = 2; i <= Mailbox::most_events; ++i)
        mailbox.push(numbered(static_cast<std::int64_t>(i)));
    CHECK(owed->processing());
    mailbox.push(numbered(0));
    CHECK_FALSE(owed->processing());
    CHECK(owed.use_count() == 1);
}

TEST_CASE("mailbox: what fits is discarded or counted, the others stay in their order")
{
    Mailbox mailbox;
    const auto live = [](const Event& event) { return !event.identity.lossless; };
    for (std::int64_t i = 1; i <= 4; ++i)
        mailbox.push(numbered(i, i % 2 == 0));
    CHECK(mailbox.count(live) == 2);
    mailbox.discard(live);
    CHECK(mailbox.count(live) == 0);
    CHECK(mailbox.events() == 2);
    CHECK(next_sequence(mailbox) == 2);
    CHECK(next_sequence(mailbox) == 4);
}

TEST_CASE("mailbox: a nudge makes it ready without an item, once")
{
    Mailbox mailbox;
    CHECK_FALSE(mailbox.ready());
    mailbox.nudge();
    CHECK(mailbox.ready());
    CHECK_FALSE(mailbox.pop());
    CHECK_FALSE(mailbox.ready());
}

TEST_CASE("mailbox: for a halted drone an event is nothing to wake for, a command is")
{
    Mailbox mailbox;
    mailbox.push(numbered(1));
    CHECK(mailbox.ready());
    CHECK_FALSE(mailbox.ready(false));
    mailbox.push([] {});
    CHECK(mailbox.ready(false));
}

}  // namespace hive::event
