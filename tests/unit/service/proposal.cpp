// One set from its question to its end: who is answered what, and when it is wanted no more.
#include "proposal.hpp"

#include "parameter_set.hpp"

#include <doctest/doctest.h>

using hive::Errc;
using hive::Error;
using hive::Json;
using hive::ParameterSet;
using hive::service::Proposal;

namespace {

/// Writes down what somebody is answered.
struct Asker {
    std::vector<std::string> answers;
    bool connected = true;

    Proposal::Answer answer()
    {
        return [this](const hive::event::Outcome& outcome) {
            const auto* error = std::get_if<Error>(&outcome);
            answers.push_back(error ? std::string(hive::info(error->code()).token) : std::get<Json>(outcome).dump());
        };
    }
    Proposal proposal(std::optional<std::int64_t> token)
    {
        return Proposal({.values = {{"value", 2}},
                         .deadline = {},
                         .token = token,
                         .asker = "asker",
                         .connection = nullptr,
                         .connected = [this] { return connected; },
                         .answer = answer()});
    }
};

using Answers = std::vector<std::string>;

}  // namespace

TEST_CASE("proposal: a plain set decides itself and is confirmed once")
{
    Asker asker;
    auto set = asker.proposal({});
    CHECK_FALSE(set.by_asker());
    set.commit();
    CHECK(set.committed());
    set.confirm({{"value", 2}});
    set.give_up(Error(Errc::timeout, "late"));
    CHECK(set.committed());
    CHECK(asker.answers == Answers{R"({"value":2})"});
}

TEST_CASE("proposal: a set that is given up is answered at once, and never again")
{
    Asker asker;
    auto set = asker.proposal({});
    set.give_up(Error(Errc::timeout, "late"));
    CHECK(asker.answers == Answers{"timeout"});
    CHECK_FALSE(set.wanted());
    set.give_up(Error(Errc::refused, "no"));
    CHECK(asker.answers.size() == 1);
}

TEST_CASE("proposal: prepare and commit are two questions with an answer each")
{
    Asker asker, again;
    auto set = asker.proposal(7);
    CHECK(set.has(7, nullptr));
    CHECK_FALSE(set.has(8, nullptr));
    set.prepare({{"tried", true}});
    CHECK(set.prepared());
    CHECK(set.wanted());
    CHECK(asker.answers == Answers{R"({"tried":true})"});
    set.commit(again.answer());
    CHECK(set.committed());
    CHECK_FALSE(set.undecided());
    CHECK(again.answers.empty());
    set.confirm({{"kept", true}});
    CHECK(asker.answers.size() == 1);
    CHECK(again.answers == Answers{R"({"kept":true})"});
}

TEST_CASE("proposal: a prepare is not wanted any more when its asker is gone; a plain set is")
{
    Asker asker;
    auto prepare = asker.proposal(7);
    auto plain = asker.proposal({});
    asker.connected = false;
    CHECK_FALSE(prepare.wanted());
    CHECK(prepare.undecided());
    CHECK(plain.wanted());
}

TEST_CASE("proposal: what the drone's code has taken does not matter when the set was given up meanwhile")
{
    Asker asker;
    auto set = asker.proposal(7);
    set.give_up(Error(Errc::timeout, "late"));
    set.prepare({{"tried", true}});
    CHECK_FALSE(set.prepared());
    CHECK(asker.answers == Answers{"timeout"});
}

TEST_CASE("proposal: giving up what was prepared answers nobody a second time")
{
    Asker asker;
    auto set = asker.proposal(7);
    set.prepare({{"tried", true}});
    set.give_up(Error(Errc::refused, "aborted"));
    CHECK_FALSE(set.undecided());
    CHECK(asker.answers.size() == 1);
}

TEST_CASE("parameter set: what is tried is told only once it is read back, and can be put back")
{
    int value = 1;
    std::string word = "old";
    ParameterSet parameters;
    parameters.add({.name = "value",
                    .type = hive::ParameterType::integer,
                    .default_value = {},
                    .least = {},
                    .most = {},
                    .choices = {},
                    .unit = {},
                    .help = {}},
                   value);
    parameters.add({.name = "word",
                    .type = hive::ParameterType::text,
                    .default_value = {},
                    .least = {},
                    .most = {},
                    .choices = {},
                    .unit = {},
                    .help = {}},
                   word);
    const Json before{{"value", 1}, {"word", "old"}}, wanted{{"value", 2}};
    parameters.assign(parameters.checked(wanted));
    word = "changed by on_change";
    CHECK(value == 2);
    CHECK(parameters.values() == before);
    CHECK(parameters.assigned(wanted) == wanted);
    CHECK(parameters.changed().empty());
    SUBCASE("put back")
    {
        parameters.put_back();
        CHECK(value == 1);
        CHECK(word == "old");
        CHECK(parameters.values() == before);
    }
    SUBCASE("kept")
    {
        parameters.read_back(wanted);
        CHECK(parameters.values() == Json{{"value", 2}, {"word", "changed by on_change"}});
        CHECK(parameters.asked() == parameters.values());
        CHECK(parameters.changed().size() == 2);
    }
    SUBCASE("kept as another value: what was asked for is remembered until the drone's code changes it again")
    {
        value = 3;
        parameters.read_back(wanted);
        CHECK(parameters.values({"value"}) == Json{{"value", 3}});
        CHECK(parameters.asked({"value"}) == wanted);
        CHECK(parameters.changed().at("value") == 2);
        parameters.read_back({{"word", "new"}});
        CHECK(parameters.asked() == Json{{"value", 2}, {"word", "new"}});
        value = 4;
        parameters.read_back({{"word", std::string(10'000, 'x')}});  // too much to be remembered
        CHECK(parameters.asked() == parameters.values());
        CHECK(parameters.values({"value"}) == Json{{"value", 4}});
    }
}
