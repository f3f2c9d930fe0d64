// Tests of tables and their JSON twin.
#include "words/format.hpp"
#include "words/table.hpp"

#include <doctest/doctest.h>

using namespace hivectl;

namespace {

const std::vector<Column> columns{{"NAME", "name"}, {"UPTIME", "uptime_us", as_duration}, {"N", "n"}, {"", "mark"}};
const std::vector<Row> rows{{{"name", "camera"}, {"uptime_us", 1500}, {"n", 7}, {"mark", "<-"}},
                            {{"name", "f\xC3\xA9"}, {"uptime_us", nullptr}, {"n", 123}}};

}  // namespace

TEST_CASE("table: texts stand left, numbers right, what is unknown is a dash, and no line ends with blanks")
{
    CHECK(table_text(columns, rows)
          == "NAME    UPTIME    N\n"
             "camera    1 ms    7  <-\n"
             "f\xC3\xA9           -  123\n");
}

TEST_CASE("table: without rows there is no line of titles, and the JSON is an empty array")
{
    CHECK(table_text(columns, {}).empty());
    CHECK(json_array({}) == "[]");
}

TEST_CASE("table: JSON has the same rows with raw numbers, in the order of the fields")
{
    CHECK(json_array(rows)
          == "[{\"name\":\"camera\",\"uptime_us\":1500,\"n\":7,\"mark\":\"<-\"},{\"name\":\"f\xC3\xA9\",\"uptime_us\":"
             "null,\"n\":123}]");
}

TEST_CASE("table: a line end in a value does not make a line")
{
    CHECK(table_text({{"TEXT", "text"}}, {{{"text", "a\nb"}}}) == "TEXT\na\\nb\n");
}

TEST_CASE("table: a column that may be left out is, unless a row has something else there than the usual")
{
    const std::vector<Column> some{{"NAME", "name"}, {"LOST", "lost", nullptr, nothing}, {"BY", "by", nullptr, "both"}};
    CHECK(table_text(some, {{{"name", "a"}, {"lost", 0}, {"by", "both"}}, {{"name", "b"}, {"lost", nullptr}}})
          == "NAME\na\nb\n");
    CHECK(table_text(some, {{{"name", "a"}, {"lost", 0}, {"by", "sender"}}, {{"name", "b"}, {"lost", 2}}})
          == "NAME  LOST  BY\na        0  sender\nb        2  -\n");
}

namespace {

const std::vector<Column> broad{
    {"NAME", "name"}, {"N", "n"}, {"STATE", "state", nullptr, {}, state_colour}, {"NOTE", "note"}};
const std::vector<Row> notes{
    {{"name", "camera"}, {"n", 7}, {"state", "idle"}, {"note", "the file clip.mp4 is missing or cannot be read"}},
    {{"name", "face"}, {"n", 12}, {"state", "gone"}, {"note", nullptr}}};

}  // namespace

TEST_CASE("table: a long text is shortened to the width of the terminal")
{
    CHECK(table_text(broad, notes, {.columns = 45})
          == "NAME     N  STATE  NOTE\n"
             "camera   7  idle   the file clip.mp4 is miss\xE2\x80\xA6\n"
             "face    12  gone   -\n");
    CHECK(table_text(broad, notes, {.columns = 66}) == table_text(broad, notes));
}

TEST_CASE("table: details are left out where shortened texts do not fit, and only there")
{
    auto columns = broad;
    for (std::size_t i = 2; i < columns.size(); ++i)
        columns[i] = detail(columns[i]);
    CHECK(table_text(columns, notes, {.columns = 32})
          == "NAME     N\n"
             "camera   7\n"
             "face    12\n");
    CHECK(table_text(columns, notes, {.columns = 45}) == table_text(broad, notes, {.columns = 45}));
    CHECK(table_text(columns, notes) == table_text(broad, notes));
}

TEST_CASE("table: rows that do not fit even with shortened texts become records, with whole texts")
{
    CHECK(table_text(broad, notes, {.columns = 32})
          == "camera\n"
             "  N 7  STATE idle\n"
             "  NOTE the file clip.mp4 is\n"
             "    missing or cannot be read\n"
             "face\n"
             "  N 12  STATE gone\n");
}

TEST_CASE("table: the state and losses are coloured where the page has colour, and take no more room")
{
    const auto text = table_text(broad, notes, {.columns = 45, .colour = true});
    CHECK(text.find("  7  \x1b[32midle\x1b[0m   the") != std::string::npos);
    CHECK(text.find(" 12  \x1b[31mgone\x1b[0m   -") != std::string::npos);
    CHECK(loss_colour(3) == Colour::red);
    CHECK(loss_colour(0) == Colour::none);
    CHECK(loss_colour(nullptr) == Colour::none);
}
