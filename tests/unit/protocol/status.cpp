// Tests of the status as values: to JSON and back, the ledger, and pages of many edges.
#include <hive/status.hpp>

#include <doctest/doctest.h>

using namespace hive;

namespace {

EdgeStatus edge(const std::string& receiver)
{
    EdgeStatus edge{.receiver = receiver, .connected = true, .registration = 5, .encoding = "jpeg:80"};
    edge.events.came(7);
    edge.events.went(Fate::lost_killed, 2);
    edge.why = Reason::place_kept;
    return edge;
}

Status with_edges(int first, int second)
{
    Status status{.name = "camera", .kind = "camera"};
    for (const auto& [name, count] : {std::pair{"image", first}, {"small", second}}) {
        OutputStatus output{.name = name, .type = "image/jpeg"};
        for (int i = 0; i < count; ++i)
            output.edges.push_back(edge(std::string(name) + std::to_string(i)));
        status.outputs.push_back(output);
    }
    return status;
}

}  // namespace

TEST_CASE("status: what was written as JSON reads as the same JSON")
{
    auto status = with_edges(2, 1);
    status.state = State::halted;
    status.why = Reason::halted;
    status.last_exception = ExceptionStatus{.code = "failed", .text = "x", .sequence = 3};
    status.inputs.push_back({.input = "image", .from = "a.b", .received = 9, .queued = 2, .why = Reason::refused});
    status.left.push_back({.input = "image", .processed = 4});
    status.matching.push_back({.inputs = {"a", "b"}, .sets = 1, .missing = {{"a", 2}}});
    const auto again = status_from_json(to_json(status));
    CHECK(to_json(again) == to_json(status));
    CHECK(again.outputs[0].edges[1].events == status.outputs[0].edges[1].events);
}

TEST_CASE("ledger: what came and has not gone is in flight")
{
    const auto events = edge("x").events;
    CHECK(events.in_flight() == 5);
    CHECK(events.lost() == 2);
}

TEST_CASE("status pages: all edges are told, each once, in answers that fit into a header")
{
    for (const auto& [first, second] : {std::pair{0, 0}, {3, 2}, {128, 0}, {100, 100}, {300, 17}}) {
        CAPTURE(first);
        const auto whole = with_edges(first, second);
        auto read = page_of(whole, 0);
        int pages = 1;
        for (; edges_left_out(read) > 0; ++pages) {
            REQUIRE(pages < 20);
            auto page = page_of(whole, edges_listed(read));
            REQUIRE(edges_listed(page) > 0);
            CHECK(edges_listed(page) <= 128);
            CHECK(to_text(to_json(page)).size() < 60'000);
            add_page(read, std::move(page));
        }
        CHECK(to_json(read) == to_json(whole));
        CHECK((pages == 1) == (first + second <= 128));
    }
}

TEST_CASE("status pages: one that begins after the last edge has none")
{
    const auto page = page_of(with_edges(3, 2), 5);
    CHECK(edges_listed(page) == 0);
    CHECK(edges_left_out(page) == 0);
}
