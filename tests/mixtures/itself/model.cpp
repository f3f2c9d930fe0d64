// What is promised, and what orders end.
#include "../model.hpp"

#include <doctest/doctest.h>

using namespace hive::mixtures;

namespace {

Stage plain(std::vector<std::string> drones) { return {.drones = std::move(drones), .options = {}}; }

Stage shared(std::vector<std::string> drones)
{
    Stage stage = plain(std::move(drones));
    stage.options.group = "group";
    return stage;
}

Outcome result(std::int64_t sequence, std::vector<std::string> hops)
{
    return {.sender = hops.back(), .text = {}, .epoch = 1, .sequence = sequence, .hops = std::move(hops)};
}

Outcome exception(std::int64_t sequence, const std::string& sender, std::vector<std::string> hops = {})
{
    return {
        .failed = true, .sender = sender, .text = "failed", .epoch = 1, .sequence = sequence, .hops = std::move(hops)};
}

/// All drones are connected.
Model begun(std::vector<Stage> stages, bool ordered = false)
{
    Model model({.ordered = ordered, .stages = std::move(stages)});
    for (const auto& drone : model.excused())
        model.whole(drone, 1, 0);
    return model;
}

}  // namespace

TEST_CASE("mixtures: each plain drone owes an answer, a group owes one together")
{
    auto each = begun({plain({"a1", "a2"})}), together = begun({shared({"a1", "a2"})});
    CHECK_FALSE(each.came(result(1, {"a1"})));
    CHECK_FALSE(together.came(result(1, {"a1"})));
    CHECK(each.missing(1, 1).size() == 1);
    CHECK(together.missing(1, 1).empty());
    CHECK_FALSE(each.came(result(1, {"a2"})));
    CHECK(each.missing(1, 1).empty());
    CHECK(together.came(result(1, {"a2"})));
    CHECK(together.missing(1, 3).size() == 2);
}

TEST_CASE("mixtures: ways through two plain stages multiply, and an exception of the first ends its own")
{
    auto model = begun({plain({"a1", "a2"}), plain({"b1", "b2"})});
    CHECK(model.missing(1, 1).size() == 4);
    CHECK_FALSE(model.came(exception(1, "a1")));
    CHECK(model.missing(1, 1).size() == 2);
    CHECK_FALSE(model.came(result(1, {"a2", "b1"})));
    CHECK_FALSE(model.came(exception(1, "b2", {"a2"})));
    CHECK(model.missing(1, 1).empty());
    CHECK(model.came(result(1, {"a1", "b1"})));
    CHECK(model.came(exception(1, "a2")));
}

TEST_CASE("mixtures: a result and an exception of shared work are two answers")
{
    auto model = begun({shared({"a1", "a2"}), shared({"b1"})});
    CHECK_FALSE(model.came(result(1, {"a1", "b1"})));
    CHECK(model.came(exception(1, "source")));
    CHECK_FALSE(model.came(exception(2, "b1", {"a2"})));
    CHECK(model.came(result(2, {"a1", "b1"})));
}

TEST_CASE("mixtures: a plain drone that an order disconnects owes nothing until it is connected again")
{
    auto model = begun({plain({"a1", "a2"})});
    model.before({.verb = Verb::disconnect, .drone = "a1", .sender = source});
    CHECK(model.excused() == std::vector<std::string>{"a1"});
    CHECK(model.missing(1, 2).size() == 2);  // those of a2
    model.whole("a1", 1, 5);
    CHECK(model.missing(1, 6).size() == 6 + 1);
    CHECK(model.was_excused());
}

TEST_CASE("mixtures: a kill, a halt and leaving a group are no excuse")
{
    for (const auto verb : {Verb::kill, Verb::halt, Verb::freeze}) {
        auto model = begun({plain({"a1"}), shared({"b1", "b2"})});
        model.before({.verb = verb, .drone = "a1"});
        model.before({.verb = verb, .drone = "b1"});
        CHECK(model.excused().empty());
    }
    auto model = begun({plain({"a1"}), shared({"b1", "b2"})});
    model.before({.verb = Verb::stop, .drone = "b1"});
    CHECK(model.excused().empty());
    model.before({.verb = Verb::disconnect, .drone = "b2", .sender = "a1"});
    CHECK(model.excused() == std::vector<std::string>{"a1"});
}

TEST_CASE("mixtures: the times of two partitions add up if no drone could reconnect in between")
{
    for (const bool checked : {false, true}) {
        auto model = begun({plain({"a1"})});
        model.before({.verb = Verb::part, .number = 15'000, .settle = checked});
        model.before({.verb = Verb::part, .number = 15'000});
        CHECK(model.excused() == (checked ? std::vector<std::string>{} : std::vector<std::string>{""}));
    }
}

TEST_CASE("mixtures: a place may be given up when its drone has been dead for 20 s")
{
    const auto after = [](int seconds) { return Model::Time(std::chrono::seconds(seconds)); };
    for (const int seconds : {20, 21}) {
        auto model = begun({plain({"a1"})});
        model.before({.verb = Verb::kill, .drone = "a1"}, after(0));
        model.before({.verb = Verb::feed}, after(seconds));
        CHECK(model.excused() == (seconds == 20 ? std::vector<std::string>{} : std::vector<std::string>{"a1"}));
    }
}

TEST_CASE("mixtures: what is collected in order is in order")
{
    auto ordered = begun({shared({"a1", "a2"})}, true), any = begun({shared({"a1", "a2"})});
    for (auto* model : {&ordered, &any})
        CHECK_FALSE(model->came(result(2, {"a1"})));
    CHECK(ordered.came(result(1, {"a2"})));
    CHECK_FALSE(any.came(result(1, {"a2"})));
}

TEST_CASE("mixtures: of two receivers that were given up at one event each has an exception of its own")
{
    auto model = begun({plain({"a1", "a2"})});
    const auto given_up = [](const std::string& receiver) {
        hive::Event event;
        event.identity = {.source = "source", .epoch = 1, .sequence = 1, .hops = {}};
        event.identity.shares = {{.of = "source.tick", .epoch = 1, .turn = 1, .to = receiver}};
        event.sender = "source";
        event.header = {{"code", "abandoned"}, {"text", "given up after 3 attempts"}};
        return outcome_of(event, true);
    };
    CHECK_FALSE(model.came(given_up("a1.image")));
    CHECK(model.missing(1, 1).size() == 1);
    CHECK_FALSE(model.came(given_up("a2.image")));
    CHECK(model.missing(1, 1).empty());
    CHECK(model.came(given_up("a1.image")));
    CHECK(model.came(result(1, {"a1"})));
    model.before({.verb = Verb::kill, .drone = "a1"});  // the result may have come before that
    CHECK_FALSE(model.came(result(1, {"a1"})));
}
