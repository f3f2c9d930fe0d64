// Tests what a second collector printed, and its exit code.
#include "../printed.hpp"

#include <doctest/doctest.h>

using namespace hive;
using namespace hive::mixtures;

namespace {

std::string line(int sequence) { return R"({"source":"source","epoch":7,"seq":)" + std::to_string(sequence) + "}\n"; }

Outcome answer(int sequence, bool failed = false)
{
    return {.failed = failed, .sender = "a1", .text = "failed", .epoch = 7, .sequence = sequence, .hops = {"a1"}};
}

/// One worker, and as many results as there are sequences.
Model collected(const std::vector<int>& sequences)
{
    Model model({.stages = {{.drones = {"a1"}, .options = {}}}});
    for (const auto sequence : sequences)
        CHECK_FALSE(model.came(answer(sequence)));
    return model;
}

std::size_t wrong(const std::string& log, int exit_code, const Model& model, bool first = true)
{
    return wrongly_printed(printed_in(log, exit_code), model,
                           {.epoch = 7, .produced = 2, .lossless = true, .first = first})
        .size();
}

}  // namespace

TEST_CASE("mixtures: hivectl results exits with 0 if it has printed every result")
{
    const auto model = collected({1, 2});
    CHECK(wrong(line(1) + line(2), 0, model) == 0);
    CHECK(wrong(line(2), 0, model) == 1);
    CHECK(wrong("hivectl results: 1 received\n" + line(2), 8, model) == 0);
    CHECK(wrong(line(1) + line(2), 8, model) == 1);
    CHECK(wrong(line(1) + line(2), 8, model, false) == 0);
    CHECK(wrong(line(1) + line(2) + line(2), 0, model) == 1);
    CHECK(wrong(line(1) + line(2), 124, model) == 1);
}

TEST_CASE("mixtures: an exception instead of a result is a reason for 8")
{
    auto model = collected({1, 2});
    CHECK_FALSE(model.came(answer(3, true)));
    CHECK(wrong(line(1) + line(2), 8, model) == 0);
}
