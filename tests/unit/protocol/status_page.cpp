// A status that is too large for one answer comes in pages.
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
