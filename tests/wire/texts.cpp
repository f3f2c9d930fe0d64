// JSON texts, names, globs, media types and parameter values.
#include "vectors.hpp"

#include <hive/interface.hpp>
#include <hive/name.hpp>
#include <hive/transfer.hpp>

namespace hive::wire {

TEST_CASE("JSON vectors: each text is accepted with its value, or refused with its code")
{
    for (const auto& row : read_vectors("json.jsonl", 180)) {
        CAPTURE(row.at("name"));
        const std::string text = input_of(row);
        Json value;
        check_outcome(row, error_of([&] { value = parse_json(text); }));
        if (row.contains("value"))
            CHECK_EQ(value, row.at("value"));
        if (row.value("ok", false))
            CHECK_EQ(parse_json(to_text(value), {.bytes = 1 << 20}), value);
    }
}

TEST_CASE("name vectors: the grammar of names")
{
    for (const auto& row : read_vectors("names.jsonl", 55)) {
        CAPTURE(row.at("name"));
        const std::string text = input_of(row);
        const bool ok = row.at("ok").get<bool>();
        CHECK_EQ(is_name(text), ok);
        CHECK_EQ(error_of([&] { require_name(text, "drone"); }),
                 ok ? std::nullopt : std::optional(Errc::invalid_argument));
    }
}

TEST_CASE("glob vectors: star and question mark, nothing else")
{
    for (const auto& row : read_vectors("globs.jsonl", 30)) {
        CAPTURE(row.at("name"));
        CHECK_EQ(matches_glob(row.at("pattern").get<std::string>(), row.at("text").get<std::string>()),
                 row.at("match").get<bool>());
    }
}

TEST_CASE("type vectors: which outputs fit which inputs, in both directions")
{
    for (const auto& row : read_vectors("types.jsonl", 30)) {
        CAPTURE(row.at("name"));
        const auto output = row.at("output").get<std::string>(), input = row.at("input").get<std::string>();
        CHECK_EQ(types_fit(output, input), row.at("fit").get<bool>());
        CHECK_EQ(types_fit(input, output), row.at("fit").get<bool>());
    }
}

TEST_CASE("parameter vectors: the value a parameter takes, or the refusal")
{
    for (const auto& row : read_vectors("parameters.jsonl", 130)) {
        CAPTURE(row.at("name"));
        const Json description{{"kind", "k"},
                               {"inputs", Json::array()},
                               {"outputs", Json::array()},
                               {"parameters", {row.at("parameter")}}};
        const auto parameter = interface_from_json(description).parameters.at(0);
        Json value;
        check_outcome(row, error_of([&] { value = checked_value(parameter, row.at("value")); }));
        if (!row.contains("result"))
            continue;
        CHECK_EQ(value, row.at("result"));
        CHECK_EQ(value.is_number_float(), row.at("result").is_number_float());
        CHECK_EQ(checked_value(parameter, value), value);
    }
}

}  // namespace hive::wire
