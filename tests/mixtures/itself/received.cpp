// Tests what bystanders of a source must have received.
#include "../received.hpp"

#include <doctest/doctest.h>

using namespace hive::mixtures;

namespace {

Model with_recorder()
{
    Model model({.bystanders = {recorder}, .stages = {{.drones = {"a1"}, .options = {}}}});
    CHECK(model.excused() == std::vector{recorder});  // it is connected last
    model.whole(recorder, 7, 1);
    return model;
}

std::size_t wrong(const std::map<std::pair<std::int64_t, std::int64_t>, int>& times, const Model& model,
                  const Problems& more = {})
{
    return wrongly_received({.way = {recorder}, .what = "recordings", .times = times, .wrong = more}, model,
                            {.epoch = 7, .produced = 3, .lossless = true})
        .size();
}

}  // namespace

TEST_CASE("mixtures: a bystander gets each event once, from when it is connected")
{
    const auto model = with_recorder();
    CHECK(wrong({{{7, 1}, 1}, {{7, 2}, 1}, {{7, 3}, 1}}, model) == 0);
    CHECK(wrong({{{7, 2}, 1}, {{7, 3}, 1}}, model) == 0);
    CHECK(wrong({{{7, 1}, 1}, {{7, 2}, 1}}, model) == 1);
    CHECK(wrong({{{6, 9}, 2}, {{7, 2}, 1}, {{7, 3}, 1}}, model) == 1);
    CHECK(wrong({{{7, 2}, 1}, {{7, 3}, 1}}, model, {"the file has no end"}) == 1);
}

TEST_CASE("mixtures: a bystander does not get what it has crashed at three times")
{
    Model model({.bystanders = {forker, joiner}, .stages = {{.drones = {"a1"}, .options = {}}}});
    for (const auto& drone : {forker, joiner})
        model.whole(drone, 7, 0);
    CHECK(model.owes({forker}, 7, 1));
    CHECK_FALSE(model.came({.failed = true, .sender = forker, .epoch = 7, .sequence = 1, .hops = {forker, joiner}}));
    CHECK(model.owes({forker}, 7, 1));
    CHECK_FALSE(model.owes({forker, joiner}, 7, 1));
    CHECK_FALSE(model.came({.failed = true, .sender = source, .epoch = 7, .sequence = 2, .hops = {source, forker}}));
    CHECK_FALSE(model.owes({forker}, 7, 2));
    CHECK(model.missing(7, 2).size() == 2);  // those of a1
}

TEST_CASE("mixtures: a source whose group has no member goes on for a bystander")
{
    Stage group{.drones = {"a1"}, .options = {}};
    group.options.group = "group";
    for (const auto& bystanders : {std::vector<std::string>{}, {recorder}}) {
        Model model({.bystanders = bystanders, .stages = {group}});
        model.whole(recorder, 7, 1);
        model.before({.verb = Verb::disconnect, .drone = "a1", .sender = source});
        CHECK(model.missing(7, 2).size() == (bystanders.empty() ? 2 : 0));
    }
}

TEST_CASE("mixtures: a source that is stopped does not know its receivers before they have come back")
{
    auto model = with_recorder();
    model.before({.verb = Verb::stop, .drone = source});
    CHECK(model.excused() == std::vector<std::string>{"a1", recorder});
    model.before({.verb = Verb::start, .drone = source});
    CHECK_FALSE(model.owes({recorder}, 8, 1));
    model.whole(recorder, 8, 5);
    CHECK_FALSE(model.owes({recorder}, 8, 5));
    CHECK(model.owes({recorder}, 8, 6));
}
