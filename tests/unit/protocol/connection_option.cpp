// The table of the options of a connection: each is read back as it was written, in each form, and nothing else is
// taken.
#include <hive/connection_option.hpp>
#include <hive/protocol/connect_text.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

using namespace hive;

namespace {

struct Values {
    std::vector<Json> good, bad;
};

const std::vector<Json> no_flags{nullptr, 1, "true"};

/// A value of each option that is not the usual one, and what is none.
const std::map<std::string_view, Values> values{
    {"stream", {{true}, no_flags}},
    {"notify", {{true}, no_flags}},
    {"window", {{2, 64}, {0, 65, -1, 2.5, true, "2", nullptr, 1e300, std::nan("")}}},
    {"first_frame", {{true}, no_flags}},
    {"group", {{"faces"}, {"a b", "../x", 1, nullptr}}},
    {"lease", {{0.05, 1.005, 2, 86'400}, {0, 0.049, 86'401, "2", true, nullptr}}},
    {"encoding", {{"raw", "jpeg:80"}, {"jpeg:x", 1, nullptr}}}};

}  // namespace

TEST_CASE("connection option: each has another word, and each field of the protocol one option")
{
    std::set<std::string_view> names, fields;
    for (const auto& option : connection_option_table()) {
        names.insert(option.name);
        fields.insert(option.field);
        CHECK(values.contains(option.name));
    }
    CHECK(names.size() == connection_option_table().size());
    CHECK(fields.size() == names.size());
    const ConnectionOptions all{
        Transfer::streaming, Delivery::notification, 2, "g", true, std::chrono::seconds(1), "raw"};
    const auto said = to_json(all);
    for (const auto& [field, value] : said.items())
        CHECK(fields.contains(field));
    CHECK(said.size() == fields.size());
}

TEST_CASE("connection option: what is set is said, as a value and as a text, and what is wrong changes nothing")
{
    for (const auto& option : connection_option_table()) {
        CAPTURE(option.name);
        for (const auto& good : values.at(option.name).good) {
            CAPTURE(good);
            ConnectionOptions options, again;
            CHECK(option.set(options, good));
            CHECK(option.value(options) == good);
            CHECK(option.is_given(options));
            CHECK(connection_options(to_json(options)) == options);
            if (!option.is_flag())
                CHECK(option.set_text(again, option.text(options)));
            else
                CHECK(option.set(again, true));
            CHECK(again == options);
            for (const auto& bad : values.at(option.name).bad)
                CHECK_FALSE(option.set(again, bad));
            CHECK(again == options);
        }
        CHECK_FALSE(option.is_given({}));
    }
}

TEST_CASE("connection option: any that go together come back from one word")
{
    const auto table = connection_option_table();
    for (unsigned chosen = 0; chosen < 1U << table.size(); ++chosen) {
        protocol::Connect connect{.drone = "camera", .output = "image", .input = "image", .options = {}};
        std::set<std::string_view> given;
        for (std::size_t i = 0; i < table.size(); ++i)
            if ((chosen >> i & 1) != 0) {
                CHECK(table[i].set(connect.options, values.at(table[i].name).good.front()));
                given.insert(table[i].name);
            }
        const auto clashes = std::ranges::count_if(connection_clashes(), [&](const ConnectionClash& clash) {
            return given.contains(clash.one) && given.contains(clash.other);
        });
        if (clashes > 0 || (given.contains("lease") && !given.contains("group")))
            continue;
        CHECK(protocol::connect_from_text(to_text(connect)).options == connect.options);
    }
}
