// Cuts a status with many rows into pages, and joins them.
#include <hive/status.hpp>

#include <algorithm>

namespace hive {
namespace {

/// Calls `call` with each list of rows, in the order of pages.
template <class AnyStatus, class Call>
void for_rows(AnyStatus& status, const Call& call)
{
    call(status.inputs);
    call(status.left);
    for (auto& output : status.outputs)
        call(output.edges);
}

/// Keeps as many rows as one answer holds.
class Cut {
public:
    explicit Cut(std::int64_t skip) : skip_(static_cast<std::size_t>(std::max<std::int64_t>(0, skip))) {}

    template <class Row>
    void operator()(std::vector<Row>& rows)
    {
        const auto skipped = std::min(skip_, rows.size());
        skip_ -= skipped;
        rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(skipped));
        const auto end = std::ranges::find_if(rows, [this](const Row& row) { return !fits(row); });
        left_out_ += rows.end() - end;
        rows.erase(end, rows.end());
    }
    [[nodiscard]] std::int64_t left_out() const { return left_out_; }

private:
    template <class Row>
    bool fits(const Row& row)
    {
        text_ -= std::min(text_, to_text(to_json(row)).size());
        full_ = full_ || rows_ == max_rows || text_ == 0;
        rows_ += full_ ? 0 : 1;
        return !full_;
    }

    static constexpr std::size_t max_rows = 128;
    std::size_t skip_, rows_ = 0;
    bool full_ = false;
    std::size_t text_ = 40 * 1024;  // of a header of 64 KiB; the rest of the status needs space as well
    std::int64_t left_out_ = 0;
};

}  // namespace

Status page_of(Status status, std::int64_t skip)
{
    Cut cut(skip);
    for_rows(status, [&](auto& rows) { cut(rows); });
    status.rows_left_out = cut.left_out();
    return status;
}

std::int64_t rows_listed(const Status& status)
{
    std::size_t listed = 0;
    for_rows(status, [&](const auto& rows) { listed += rows.size(); });
    return static_cast<std::int64_t>(listed);
}

void add_page(Status& status, Status page)
{
    const auto append = [](auto& rows, auto& more) { std::ranges::move(more, std::back_inserter(rows)); };
    append(status.inputs, page.inputs);
    append(status.left, page.left);
    for (auto& output : status.outputs)
        if (const auto more = std::ranges::find(page.outputs, output.name, &OutputStatus::name);
            more != page.outputs.end())
            append(output.edges, more->edges);
    status.rows_left_out = page.rows_left_out;
}

}  // namespace hive
