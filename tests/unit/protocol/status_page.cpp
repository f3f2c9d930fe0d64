// A status that is too large for one answer comes in pages.
#include <hive/status.hpp>

#include <doctest/doctest.h>

#include <array>

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

InputStatus input(int number)
{
    return {.input = "image", .from = "camera.image" + std::to_string(number), .received = 1, .processed = 1};
}

Status with_rows(int inputs, int left, int first, int second)
{
    Status status{.name = "camera", .kind = "camera"};
    for (int i = 0; i < inputs; ++i)
        status.inputs.push_back(input(i));
    for (int i = 0; i < left; ++i)
        status.left.push_back(input(i));
    for (const auto& [name, count] : {std::pair{"image", first}, {"small", second}}) {
        OutputStatus output{.name = name, .type = "image/jpeg"};
        for (int i = 0; i < count; ++i)
            output.edges.push_back(edge(std::string(name) + std::to_string(i)));
        status.outputs.push_back(output);
    }
    return status;
}

}  // namespace

TEST_CASE("status pages: all rows are told, each once, in answers that fit into a header")
{
    for (const auto& [inputs, left, first, second] : {std::array{0, 0, 0, 0},
                                                      {0, 0, 3, 2},
                                                      {0, 0, 128, 0},
                                                      {1, 2, 125, 0},
                                                      {0, 0, 100, 100},
                                                      {200, 3, 300, 17},
                                                      {130, 130, 0, 0}}) {
        CAPTURE(inputs);
        CAPTURE(first);
        const auto whole = with_rows(inputs, left, first, second);
        auto read = page_of(whole, 0);
        int pages = 1;
        for (; read.rows_left_out > 0; ++pages) {
            REQUIRE(pages < 20);
            auto page = page_of(whole, rows_listed(read));
            REQUIRE(rows_listed(page) > 0);
            CHECK(rows_listed(page) <= 128);
            CHECK(to_text(to_json(page)).size() < 60'000);
            add_page(read, std::move(page));
        }
        CHECK(to_json(read) == to_json(whole));
        CHECK((pages == 1) == (inputs + left + first + second <= 128));
    }
}

TEST_CASE("status pages: one that begins after the last row has none")
{
    const auto page = page_of(with_rows(1, 0, 3, 2), 6);
    CHECK(rows_listed(page) == 0);
    CHECK(page.rows_left_out == 0);
}
