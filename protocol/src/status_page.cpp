// A drone with many receivers tells its status in pages: cutting one out, and putting them together again.
#include <hive/status.hpp>

#include <algorithm>

namespace hive {
namespace {

constexpr std::size_t most_edges = 128;
/// What the edges of one answer may take of a header of 64 KiB; the rest of the status needs room as well.
constexpr std::size_t most_text = 40 * 1024;

}  // namespace

Status page_of(Status status, std::int64_t skip_edges)
{
    auto skip = static_cast<std::size_t>(std::max<std::int64_t>(0, skip_edges));
    std::size_t rows = most_edges, text = most_text;
    for (auto& output : status.outputs) {
        auto& edges = output.edges;
        const auto skipped = std::min(skip, edges.size());
        skip -= skipped;
        edges.erase(edges.begin(), edges.begin() + static_cast<std::ptrdiff_t>(skipped));
        const auto end = std::ranges::find_if(edges, [&](const EdgeStatus& edge) {
            const auto size = std::min(text, to_text(to_json(edge)).size());
            text -= size;
            const bool full = rows == 0 || text == 0;
            rows -= full ? 0 : 1;
            return full;
        });
        output.edges_left_out = edges.end() - end;
        edges.erase(end, edges.end());
    }
    return status;
}

std::int64_t edges_listed(const Status& status)
{
    std::int64_t listed = 0;
    for (const auto& output : status.outputs)
        listed += static_cast<std::int64_t>(output.edges.size());
    return listed;
}

std::int64_t edges_left_out(const Status& status)
{
    std::int64_t left_out = 0;
    for (const auto& output : status.outputs)
        left_out += output.edges_left_out;
    return left_out;
}

void add_page(Status& status, Status page)
{
    for (auto& output : status.outputs) {
        const auto more = std::ranges::find(page.outputs, output.name, &OutputStatus::name);
        output.edges_left_out = more == page.outputs.end() ? 0 : more->edges_left_out;
        if (more != page.outputs.end())
            std::ranges::move(more->edges, std::back_inserter(output.edges));
    }
}

}  // namespace hive
