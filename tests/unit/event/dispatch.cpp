// Events that wait for an encoding: each encoded once, in order, for those who still want it.
#include "fixtures.hpp"

#include <hive/event/dispatch.hpp>
#include <hive/event/ticket.hpp>

#include <doctest/doctest.h>

#include <stdexcept>

namespace hive::event {
namespace {

/// An encoder that writes down what it does, and the two threads as queues that the test runs by hand.
class Workshop {
public:
    Encoder encoder{
        .encodings = {{"loud", "text/loud"}},
        .encode = [this](const Event& event, const std::string& encoding) { return encode(event, encoding); }};
    std::deque<std::function<void()>> jobs, tasks;
    std::vector<std::string> encoded;      ///< "loud of 1", in order
    std::vector<std::string> transmitted;  ///< "1 to 7 as text/loud"
    std::vector<std::string> problems;
    bool throws = false;

    Dispatch dispatch{
        encoder,
        {.transmit =
             [this](const Send& send, const Emission& form) {
                 transmitted.push_back(number(form.event()) + " to " + std::to_string(send.receiver) + " as "
                                       + form.event().type);
             },
         .not_encoded = [this](const EmissionPtr&, const Error& problem) { problems.emplace_back(problem.what()); },
         .on_encoder_thread = [this](ReceiverId, std::function<void()> job) { jobs.push_back(std::move(job)); },
         .on_network_side = [this](std::function<void()> task) { tasks.push_back(std::move(task)); },
         .end = [this](ReceiverId receiver) { transmitted.push_back("end to " + std::to_string(receiver)); }}};

    void send(ReceiverId receiver, const EmissionPtr& event, const std::string& encoding)
    {
        dispatch.send({receiver, event, Delivery::data, {}}, encoding);
    }
    void run_jobs() { run(jobs); }
    void run_tasks() { run(tasks); }
    void run_all()
    {
        run_jobs();
        run_tasks();
    }

private:
    static std::string number(const Event& event) { return std::to_string(event.identity.sequence); }
    static void run(std::deque<std::function<void()>>& queue)
    {
        for (; !queue.empty(); queue.pop_front())
            queue.front()();
    }
    Event encode(const Event& event, const std::string& encoding)
    {
        encoded.push_back(encoding + " of " + number(event));
        if (throws)
            throw std::runtime_error("no voice");
        Event result = event;
        result.type = "text/loud";
        result.body = Body(std::string("LOUD"));
        return result;
    }
};

using Words = std::vector<std::string>;

}  // namespace

TEST_CASE("dispatch: the end comes behind what is still being encoded, and for the others at once")
{
    Workshop shop;
    shop.send(7, emission(1), "loud");
    shop.dispatch.end(7);
    shop.dispatch.end(8);
    CHECK(shop.transmitted == std::vector<std::string>{"end to 8"});
    shop.run_all();
    CHECK(shop.transmitted == std::vector<std::string>{"end to 8", "1 to 7 as text/loud", "end to 7"});
}

TEST_CASE("dispatch: what needs no encoding leaves at once, without the encoder thread")
{
    Workshop shop;
    shop.send(7, emission(1), "");
    CHECK(shop.transmitted == Words{"1 to 7 as image/jpeg"});
    CHECK(shop.jobs.empty());
}

TEST_CASE(
    "dispatch: an event that three receivers get in one encoding is encoded once, and once more for another encoding")
{
    Workshop shop;
    const auto event = emission(1);
    for (const ReceiverId receiver : {1, 2, 3})
        shop.send(receiver, event, "loud");
    shop.send(4, event, "loud:2");
    CHECK(shop.transmitted.empty());
    shop.run_all();
    CHECK(shop.encoded == Words{"loud of 1", "loud:2 of 1"});
    CHECK(shop.transmitted
          == Words{"1 to 1 as text/loud", "1 to 2 as text/loud", "1 to 3 as text/loud", "1 to 4 as text/loud"});
    shop.send(5, event, "loud");  // later, as with first_frame
    CHECK(shop.transmitted.back() == "1 to 5 as text/loud");
    CHECK(shop.jobs.empty());
}

TEST_CASE("dispatch: the rendition says what it is, and its header is encoded once for all")
{
    Workshop shop;
    const auto event = emission(1, false, 1000);
    shop.send(1, event, "loud");
    shop.run_all();
    const auto rendition = event->rendition("loud");
    REQUIRE(rendition);
    const Event arrived = event_from_packet(rendition->packet(protocol::PacketType::event, 1));
    CHECK(arrived.type == "text/loud");
    CHECK(arrived.size == 4);
    CHECK(arrived.identity.sequence == 1);
    CHECK(rendition->packet(protocol::PacketType::event, 1).header
          == rendition->packet(protocol::PacketType::event, 2).header);
}

TEST_CASE("dispatch: nothing overtakes an event that is being encoded, but other receivers do not wait")
{
    Workshop shop;
    shop.send(1, emission(1), "loud");
    shop.send(1, emission(2), "");
    shop.send(2, emission(2), "");
    shop.send(1, emission(3), "loud");
    CHECK(shop.transmitted == Words{"2 to 2 as image/jpeg"});
    shop.run_all();
    CHECK(shop.transmitted
          == Words{"2 to 2 as image/jpeg", "1 to 1 as text/loud", "2 to 1 as image/jpeg", "3 to 1 as text/loud"});
    shop.send(1, emission(4), "");
    CHECK(shop.transmitted.back() == "4 to 1 as image/jpeg");
}

TEST_CASE("dispatch: a rendition that is there already waits behind one that is not")
{
    Workshop shop;
    const auto known = emission(2);
    shop.send(9, known, "loud");
    shop.run_all();
    shop.send(1, emission(1), "loud");
    shop.send(1, known, "loud");
    CHECK(shop.transmitted == Words{"2 to 9 as text/loud"});
    shop.run_all();
    CHECK(shop.transmitted == Words{"2 to 9 as text/loud", "1 to 1 as text/loud", "2 to 1 as text/loud"});
    CHECK(shop.encoded == Words{"loud of 2", "loud of 1"});
}

TEST_CASE("dispatch: for a receiver that has gone nothing is encoded, and nothing is sent when it goes meanwhile")
{
    Workshop shop;
    shop.send(1, emission(1), "loud");
    shop.dispatch.forget(1);
    shop.run_all();
    CHECK(shop.encoded.empty());
    shop.send(2, emission(2), "loud");
    shop.run_jobs();
    shop.dispatch.forget(2);
    shop.run_tasks();
    CHECK(shop.encoded == Words{"loud of 2"});
    CHECK(shop.transmitted.empty());
}

TEST_CASE("dispatch: when the encoder throws, that is told once and the event goes as it is to all")
{
    Workshop shop;
    shop.throws = true;
    const auto event = emission(1);
    shop.send(1, event, "loud");
    shop.send(2, event, "loud");
    shop.run_all();
    CHECK(shop.problems == Words{"loud: no voice"});
    CHECK(shop.transmitted == Words{"1 to 1 as image/jpeg", "1 to 2 as image/jpeg"});
    CHECK(shop.encoded.size() == 1);
}

TEST_CASE("dispatch: the ticket is held while the event waits for its encoding, and not by what is kept of it")
{
    Workshop shop;
    const auto owed = std::make_shared<Acknowledgement>();
    Event event = emission(1, true)->event();
    event.ticket = {owed, true};
    std::shared_ptr<const Emission> kept;
    {
        const auto sent = std::make_shared<const Emission>(event);
        event = {};
        kept = sent->without_ticket();
        shop.send(1, sent, "loud");
    }
    CHECK(owed->processing());
    shop.run_all();
    CHECK(owed.use_count() == 1);
    CHECK_FALSE(owed->processing());
    CHECK(kept->rendition("loud"));  // what is kept finds it, too
}

TEST_CASE("dispatch: a job that ends after the module's end does nothing")
{
    std::function<void()> job, task;
    Encoder encoder{.encodings = {{"loud", "text/loud"}},
                    .encode = [](const Event& event, const std::string&) { return event; }};
    int transmitted = 0;
    {
        Dispatch dispatch(
            encoder, {.transmit = [&](const Send&, const Emission&) { ++transmitted; },
                      .not_encoded = {},
                      .on_encoder_thread = [&](ReceiverId, std::function<void()> given) { job = std::move(given); },
                      .on_network_side = [&](std::function<void()> given) { task = std::move(given); }});
        dispatch.send({1, emission(1), Delivery::data, {}}, "loud");
        job();
        REQUIRE(task);
    }
    task();
    CHECK(transmitted == 0);
}

TEST_CASE("dispatch: what is skipped for a receiver is never encoded")
{
    Workshop shop;
    Subscription slow({});
    const auto carry_out = [&](auto call) {
        for (const auto& send : decided(call).sends)
            shop.dispatch.send(send, "loud");
    };
    carry_out([&](Decisions& to) { slow.attach(1, window(1), {}, nullptr, start, to); });
    for (std::int64_t sequence = 1; sequence <= 5; ++sequence)
        carry_out([&](Decisions& to) { slow.offer(emission(sequence), start, to); });
    shop.run_all();
    carry_out([&](Decisions& to) { slow.written(1, 10, start, to); });
    carry_out([&](Decisions& to) { slow.request(1, {2, 1, 1}, {}, start, to); });
    shop.run_all();
    CHECK(shop.encoded == Words{"loud of 1", "loud of 5"});
    CHECK(slow.ledger().of(Fate::skipped) == 3);
    CHECK(slow.ledger().in_flight() == 1);
    CHECK(balanced(slow.ledger()));
}

}  // namespace hive::event
