// What parsing costs: the time of the worst texts within the limits, and the memory of texts that are refused.
#include <hive/error.hpp>
#include <hive/json.hpp>

#include <doctest/doctest.h>

#include <fstream>
#include <functional>
#include <time.h>
#include <unistd.h>

using namespace hive;

namespace {

constexpr std::size_t full = 64 * 1024;
#ifdef HIVE_SANITIZED
constexpr bool exact = false;
#else
constexpr bool exact = true;
#endif

/// `open`, then `item` as often as it fits, then `close`: at most 64 KiB.
std::string filled(const std::string& open, const std::string& item, const std::string& close)
{
    std::string text = open;
    while (text.size() + item.size() + close.size() <= full)
        text += item;
    return text + close;
}

/// Objects with as many keys as are allowed, each once.
std::string many_keys()
{
    std::string keys = "{\"0\":0";
    for (int i = 1; i < 256; ++i)
        keys += ",\"" + std::to_string(i) + "\":0";
    return filled("[0", "," + keys + "}", "]");
}

struct Text {
    std::string name;
    std::string text;
};

std::vector<Text> worst_texts()
{
    return {{"numbers", filled("[0", ",0", "]")},
            {"empty arrays", filled("[0", ",[]", "]")},
            {"empty objects", filled("[0", ",{}", "]")},
            {"small objects", filled("[0", ",{\"\":0}", "]")},
            {"wide objects", many_keys()},
            {"doubles", filled("[0", ",1.7976931348623157e308", "]")},
            {"one long number", filled("0.", "1", "")},
            {"escapes", filled("[0", ",\"\\u00e9\\u00e9\\u00e9\\u00e9\"", "]")},
            {"strings", filled("[0", ",\"\"", "]")},
            {"deep and wide", filled("[0", ",[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]", "]")},
            {"white space", filled("", " ", "{}")}};
}

std::vector<Text> refused_texts()
{
    std::vector<Text> texts;
    for (auto& [name, text] : worst_texts()) {
        text.back() = '!';
        texts.push_back({name, std::move(text)});
    }
    texts.push_back({"deep", std::string(full, '[')});
    texts.push_back({"a million brackets", std::string(1'000'000, '[')});
    texts.push_back({"long string", "\"" + std::string(full - 2, 'a') + "\""});
    texts.push_back({"ten megabytes of numbers", "[" + std::string(10'000'000, '0') + "]"});
    return texts;
}

std::size_t resident_bytes()
{
    std::ifstream statm("/proc/self/statm");
    std::size_t size = 0, resident = 0;
    statm >> size >> resident;
    return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

/// Processor time of this thread, so that a busy machine does not count.
std::int64_t cpu_us()
{
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return time.tv_sec * 1'000'000 + time.tv_nsec / 1000;
}

/// What `parse` takes; giving the value back to the heap is not parsing.
std::int64_t time_of(const std::function<Json()>& parse)
{
    const auto start = cpu_us();
    const Json value = parse();
    return cpu_us() - start;
}

}  // namespace

TEST_CASE("json: refused texts leave less than 2 MB of memory behind")
{
    const auto texts = refused_texts();
    for (const auto& row : texts) {
        CAPTURE(row.name);
        const auto before = resident_bytes();
        for (int i = 0; i < 3; ++i)
            CHECK_THROWS_AS(parse_json(row.text), Error);
        const auto after = resident_bytes();
        const auto growth = after > before ? after - before : 0;
        if (exact)
            CHECK_LE(growth, 2'000'000u);
        else
            MESSAGE(row.name << ": " << growth << " bytes under sanitizers");
    }
}

TEST_CASE(
    "json: the worst text of 64 KiB is parsed within 2 ms, or as fast as without limits where the machine is slow")
{
    for (const auto& row : worst_texts()) {
        CAPTURE(row.name);
        REQUIRE_LE(row.text.size(), full);
        auto limited = INT64_MAX, plain = INT64_MAX;  // the best of many, by turns, so that both see the same machine
        for (int i = 0; i < 20; ++i) {
            limited = std::min(limited, time_of([&] { return parse_json(row.text); }));
            plain = std::min(plain, time_of([&] { return Json::parse(row.text); }));
        }
        if (exact)
            CHECK_LE(limited, std::max<std::int64_t>(2000, plain * 2));
        if (!exact || std::getenv("HIVE_REPORT"))
            MESSAGE(row.name << ": " << limited << " us, without limits " << plain << " us");
    }
}
