// Events through drones in C: what is emitted, what callbacks return, what lives how long.
#include "world.hpp"

#include <cstring>
#include <vector>

using namespace world;

namespace {

/// A source that gives `count` numbered events on demand, each a loan of 8 KiB.
struct Source {
    hive_output* output = nullptr;
    int made = 0, count = 0;
    std::int64_t fail_at = 0;
};

hive_code produce(void* user, std::int64_t* wait_us)
{
    auto& source = *static_cast<Source*>(user);
    bool asked = false;
    *wait_us = 3'600'000'000;
    if (const hive_code code = hive_output_asked(source.output, &asked); code != HIVE_OK || !asked)
        return code;
    if (source.made == source.count)
        return HIVE_OK;
    *wait_us = 0;
    ++source.made;
    if (source.made == source.fail_at)
        return hive_output_fail(source.output, 1'700'000'000'000'000, true, HIVE_IO, "a damaged file");
    hive_loan* loan = nullptr;
    void* bytes = nullptr;
    std::size_t size = 0;
    hive_body* body = nullptr;
    REQUIRE(hive_output_loan(source.output, 8192, &loan) == HIVE_OK);
    REQUIRE(hive_loan_bytes(loan, &bytes, &size) == HIVE_OK);
    REQUIRE(size >= 8192);
    std::memset(bytes, source.made, 8192);
    REQUIRE(hive_loan_body(loan, 8192, &body) == HIVE_OK);
    CHECK(hive_loan_body(loan, 8192, &body) == HIVE_INVALID_ARGUMENT);
    const std::string header = Json{{"index", source.made}}.dump();
    const hive_code code = hive_output_emit_captured(source.output, 1'700'000'000'000'000 + source.made, true,
                                                     header.data(), header.size(), body, nullptr);
    hive_release(body);
    hive_release(loan);
    return code;
}

/// A worker that answers, fails or throws as the index says.
struct Worker {
    hive_output* output = nullptr;
    hive_body* held = nullptr;
};

hive_code work(void* user, const hive_event* event)
{
    auto& worker = *static_cast<Worker*>(user);
    const char* header = nullptr;
    std::size_t length = 0, size = 0;
    const void* bytes = nullptr;
    REQUIRE(hive_event_header(event, &header, &length) == HIVE_OK);
    REQUIRE(hive_event_bytes(event, &bytes, &size) == HIVE_OK);
    const int index = Json::parse(std::string(header, length)).at("index");
    if (index == 2)
        return hive_fail(HIVE_UNSUPPORTED, "two is not to my taste");
    if (index == 3)
        throw 42;
    if (index == 4)
        throw std::runtime_error("thrown");
    if (index == 5)
        return HIVE_REFUSED;
    if (!worker.held)
        REQUIRE(hive_event_body(event, &worker.held) == HIVE_OK);
    const std::string result = Json{{"index", index}, {"first", *static_cast<const unsigned char*>(bytes)}}.dump();
    return hive_output_emit(worker.output, result.data(), result.size(), nullptr, 0, nullptr);
}

struct Pair {
    explicit Pair(int count, std::int64_t fail_at = 0)
    {
        source.count = count;
        source.fail_at = fail_at;
        auto* from = new_drone("source");
        REQUIRE(hive_drone_output(from, "out", "application/octet-stream", "bytes", &source.output) == HIVE_OK);
        REQUIRE(hive_drone_main(from, produce, &source) == HIVE_OK);
        auto* to = new_drone("worker");
        REQUIRE(hive_drone_output(to, "result", "application/json", "results", &worker.output) == HIVE_OK);
        REQUIRE(hive_drone_on_event(to, "in", "application/*", "bytes", work, &worker) == HIVE_OK);
        sending.emplace(from);
        working.emplace(to);
        await(application, "source");
        await(application, "worker");
    }
    ~Pair()
    {
        hive_release(application);
        sending.reset();
        working.reset();
        hive_release(worker.held);
        hive_release(source.output);
        hive_release(worker.output);
    }
    Pair(const Pair&) = delete;
    Pair& operator=(const Pair&) = delete;

    Home home;
    hive_application* application = new_application();
    Source source;
    Worker worker;
    std::optional<Running> sending, working;
};

hive_event* next(hive_collector* collector)
{
    hive_event* event = nullptr;
    REQUIRE_MESSAGE(hive_collector_next(collector, patient(5000ms).count(), &event) == HIVE_OK, error());
    REQUIRE(event);
    return event;
}

Json header_of(const hive_event* event)
{
    const char* header = nullptr;
    REQUIRE(hive_event_header(event, &header, nullptr) == HIVE_OK);
    return Json::parse(header);
}

Json info_of(const hive_event* event)
{
    Text info;
    REQUIRE(hive_event_info(event, info.place(), nullptr) == HIVE_OK);
    return info.json();
}

}  // namespace

TEST_CASE("c: every event of a source on demand is worked on once; what a callback fails with is an exception with its "
          "code and text")
{
    const auto before = hive_handle_count();
    {
        Pair pair(8);
        hive_collector *results = nullptr, *exceptions = nullptr;
        REQUIRE(hive_application_collect(pair.application, R"(["worker"])", nullptr, &results) == HIVE_OK);
        REQUIRE(hive_application_exceptions(pair.application, R"(["worker"])", &exceptions) == HIVE_OK);
        Text ends;
        REQUIRE(hive_application_connect(pair.application, "source", "worker", nullptr, ends.place()) == HIVE_OK);
        CHECK(ends.json() == Json{{"sender", "source.out"}, {"receiver", "worker.in"}});
        for (const int index : {1, 6, 7, 8}) {
            auto* event = next(results);
            CHECK(header_of(event) == Json{{"index", index}, {"first", index}});
            const Json info = info_of(event);
            CHECK(info.at("source") == "source");
            CHECK(info.at("sequence") == index);
            CHECK(info.at("captured_us") == 1'700'000'000'000'000 + index);
            CHECK(info.at("lossless") == true);
            CHECK(info.at("sender") == "worker");
            CHECK(info.at("hops").at(0).at("drone") == "worker");
            CHECK(hive_event_done(event) == HIVE_OK);
            CHECK(hive_event_done(event) == HIVE_OK);
            hive_release(event);
        }
        const std::vector<std::pair<std::string, std::string>> expected{{"unsupported", "two is not to my taste"},
                                                                        {"failed", ""},
                                                                        {"failed", "thrown"},
                                                                        {"refused", hive_code_sentence(HIVE_REFUSED)}};
        for (const auto& [code, text] : expected) {
            auto* event = next(exceptions);
            CHECK(header_of(event).at("code") == code);
            if (!text.empty())
                CHECK(header_of(event).at("text") == text);
            hive_release(event);
        }
        Text counts;
        REQUIRE(hive_collector_counts(results, counts.place(), nullptr) == HIVE_OK);
        CHECK(counts.json().at("received") == 4);
        Text inputs;
        REQUIRE(hive_collector_inputs(results, inputs.place(), nullptr) == HIVE_OK);
        REQUIRE(inputs.json().size() == 1);
        CHECK(inputs.json().at(0).at("from") == "worker.result");
        CHECK(inputs.json().at(0).at("received") == 4);
        CHECK(inputs.json().at(0).at("options").at("window") == 64);
        hive_release(results);
        hive_release(exceptions);
    }
    CHECK(hive_handle_count() == before);
}

TEST_CASE("c: what a source cannot give has its number, and its exception the identity")
{
    Pair pair(3, 2);
    hive_collector *results = nullptr, *exceptions = nullptr;
    REQUIRE(hive_application_exceptions(pair.application, R"(["source"])", &exceptions) == HIVE_OK);
    REQUIRE(hive_application_collect(pair.application, R"(["source"])", nullptr, &results) == HIVE_OK);
    auto* event = next(results);
    CHECK(info_of(event).at("sequence") == 1);
    hive_release(event);
    event = next(exceptions);
    CHECK(header_of(event).at("code") == "io");
    CHECK(header_of(event).at("text") == "a damaged file");
    CHECK(info_of(event).at("sequence") == 2);
    hive_release(event);
    event = next(results);
    CHECK(info_of(event).at("sequence") == 3);
    hive_release(event);
    hive_release(results);
    hive_release(exceptions);
}

TEST_CASE("c: an event that is held stops a source whose window is one; done lets it go on while the bytes are read")
{
    Pair pair(100);
    hive_collector* collector = nullptr;
    REQUIRE(hive_application_collect(pair.application, R"(["source"])", R"({"connection": {"window": 1}})", &collector)
            == HIVE_OK);
    auto* first = next(collector);
    hive_event* second = nullptr;
    REQUIRE(hive_collector_next(collector, 200, &second) == HIVE_OK);
    CHECK(second == nullptr);
    REQUIRE(hive_event_done(first) == HIVE_OK);
    second = next(collector);
    const void* bytes = nullptr;
    std::size_t size = 0;
    REQUIRE(hive_event_bytes(first, &bytes, &size) == HIVE_OK);
    CHECK(size == 8192);
    CHECK(static_cast<const unsigned char*>(bytes)[8191] == 1);
    hive_body* body = nullptr;
    REQUIRE(hive_event_body(first, &body) == HIVE_OK);
    bool foreign = false;
    CHECK(hive_body_foreign(body, &foreign) == HIVE_OK);
    hive_release(first);
    hive_release(second);
    for (int i = 0; i < 50; ++i)
        hive_release(next(collector));  // other events, other slots
    REQUIRE(hive_body_bytes(body, &bytes, &size) == HIVE_OK);
    CHECK(static_cast<const unsigned char*>(bytes)[0] == 1);
    hive_release(collector);
    hive_application_close(pair.application);
    CHECK(static_cast<const unsigned char*>(bytes)[0] == 1);  // the memory outlives the application
    hive_release(body);
}

TEST_CASE("c: ages, hops and counters are read without JSON")
{
    Pair pair(3);
    hive_collector* collector = nullptr;
    REQUIRE(hive_application_connect(pair.application, "source", "worker", nullptr, nullptr) == HIVE_OK);
    REQUIRE(hive_application_collect(pair.application, R"(["worker.result"])", nullptr, &collector) == HIVE_OK);
    auto* event = next(collector);
    std::int64_t value = -1, wait_us = -1, work_us = -1;
    CHECK(hive_event_number(event, "sequence", &value) == HIVE_OK);
    CHECK(value >= 1);
    CHECK(hive_event_number(event, "age_us", &value) == HIVE_OK);
    CHECK(value > 0);
    CHECK(hive_event_number(event, "captured_us", &value) == HIVE_OK);
    CHECK(value > 1'700'000'000'000'000);
    CHECK(hive_event_number(event, "colour", &value) == HIVE_INVALID_ARGUMENT);
    const char* drone = nullptr;
    REQUIRE(hive_event_hop(event, 0, &drone, &wait_us, &work_us) == HIVE_OK);
    CHECK(drone == std::string("worker"));
    CHECK(wait_us >= 0);
    CHECK(work_us >= 0);
    CHECK(hive_event_hop(event, 1, &drone, &wait_us, &work_us) == HIVE_NOT_FOUND);
    CHECK(hive_collector_count(collector, "received", &value) == HIVE_OK);
    CHECK(value >= 1);
    CHECK(hive_collector_count(collector, "colour", &value) == HIVE_INVALID_ARGUMENT);
    hive_release(event);
    hive_release(collector);
}

TEST_CASE("c: a loan is at most the body of an event")
{
    const Home home;
    auto* drone = new_drone("probe");
    hive_output* output = nullptr;
    hive_loan* loan = nullptr;
    REQUIRE(hive_drone_output(drone, "out", "a/b", "", &output) == HIVE_OK);
    for (const std::size_t size : {(std::size_t{64} << 20) + 1, SIZE_MAX, SIZE_MAX - 4095}) {
        CHECK(hive_output_loan(output, size, &loan) == HIVE_TOO_LARGE);
        CHECK(loan == nullptr);
    }
    REQUIRE(hive_output_loan(output, std::size_t{64} << 20, &loan) == HIVE_OK);
    hive_release(loan);
    hive_release(output);
    hive_release(drone);
}

TEST_CASE("c: events are brought together, and an application gets the sets")
{
    const Home home;
    struct Joined {
        hive_output* output = nullptr;
        int sets = 0;
    } joined;
    Source left{.count = 5};
    auto *a = new_drone("a"), *join = new_drone("join");
    REQUIRE(hive_drone_output(a, "out", "a/b", "bytes", &left.output) == HIVE_OK);
    REQUIRE(hive_drone_main(a, produce, &left) == HIVE_OK);
    REQUIRE(hive_drone_output(join, "set", "application/json", "sets", &joined.output) == HIVE_OK);
    const auto on_set = [](void* user, const hive_event* const* events, std::size_t count) -> hive_code {
        auto& self = *static_cast<Joined*>(user);
        ++self.sets;
        Json indices = Json::array();
        for (std::size_t i = 0; i < count; ++i)
            indices.push_back(header_of(events[i]).at("index"));
        const std::string header = Json{{"indices", indices}}.dump();
        return hive_output_emit_body(self.output, header.data(), header.size(), nullptr, nullptr);
    };
    hive_matching* matching = nullptr;
    const char* inputs = R"([{"name": "x", "type": "a/b"}, {"name": "y", "type": "a/b", "help": "again"}])";
    CHECK(hive_drone_on_matched(join, R"([{"name": "x", "type": "a/b"}])", nullptr, on_set, nullptr, &joined, nullptr)
          == HIVE_INVALID_ARGUMENT);
    REQUIRE(hive_drone_on_matched(join, inputs, R"({"tolerance_us": 5})", on_set, nullptr, &joined, &matching)
            == HIVE_OK);
    REQUIRE(hive_matching_rule(matching, nullptr) == HIVE_OK);
    {
        Running sending(a), joining(join);
        auto* application = new_application();
        await(application, "a");
        await(application, "join");
        hive_collector* collector = nullptr;
        REQUIRE(hive_application_halt(application, "a") == HIVE_OK);
        REQUIRE(hive_application_connect(application, "a", "join.x", nullptr, nullptr) == HIVE_OK);
        REQUIRE(hive_application_connect(application, "a", "join.y", nullptr, nullptr) == HIVE_OK);
        REQUIRE(hive_application_collect_matched(application, R"(["a", "join"])", nullptr, nullptr, &collector)
                == HIVE_OK);
        REQUIRE(hive_application_resume(application, "a") == HIVE_OK);
        for (int index = 1; index <= 5; ++index) {
            hive_event* events[2] = {};
            std::size_t count = 0;
            REQUIRE(hive_collector_next_set(collector, patient(5000ms).count(), events, 2, &count) == HIVE_OK);
            REQUIRE(count == 2);
            CHECK(header_of(events[0]).at("index") == index);
            CHECK(header_of(events[1]).at("indices") == Json{index, index});
            hive_release(events[0]);
            hive_release(events[1]);
        }
        hive_event* event = nullptr;
        CHECK(hive_collector_next(collector, 0, &event) == HIVE_INVALID_ARGUMENT);
        std::int64_t count = 0;
        CHECK(hive_collector_count(collector, "sets", &count) == HIVE_OK);
        CHECK(count == 5);
        CHECK(hive_collector_count(collector, "received", &count) == HIVE_OK);
        CHECK(count == 10);
        Text here;
        REQUIRE(hive_collector_inputs(collector, here.place(), nullptr) == HIVE_OK);
        REQUIRE(here.json().size() == 2);
        CHECK(here.json().at(0).at("from") == "a.out");
        CHECK(here.json().at(1).at("received") == 5);
        hive_release(collector);
        hive_release(application);
    }
    for (auto* output : {left.output, joined.output})
        hive_release(output);
    hive_release(matching);
}

TEST_CASE("c: a body is made only for somebody, and what making it fails with is what emitting fails with")
{
    const Home home;
    struct Making {
        int made = 0;
        hive_code result = HIVE_OK;
        bool give = true;
    } making;
    bool wanted = false;
    const auto make = [](void* user, hive_body** body) -> hive_code {
        auto& self = *static_cast<Making*>(user);
        ++self.made;
        if (self.result != HIVE_OK)
            return hive_fail(self.result, "no film left");
        return self.give ? hive_body_new("abc", 3, body) : HIVE_OK;
    };
    auto* drone = new_drone("probe");
    hive_output* output = nullptr;
    REQUIRE(hive_drone_output(drone, "out", "a/b", "", &output) == HIVE_OK);
    REQUIRE(hive_drone_start(drone) == HIVE_OK);
    CHECK(hive_output_emit_made(output, nullptr, 0, make, &making, nullptr) == HIVE_OK);
    CHECK(hive_output_emit_captured_made(output, 1, false, nullptr, 0, make, &making, nullptr) == HIVE_OK);
    CHECK(making.made == 0);
    CHECK(hive_output_emit_made(output, nullptr, 0, nullptr, &making, nullptr) == HIVE_INVALID_ARGUMENT);

    auto* application = new_application();
    hive_collector* collector = nullptr;
    REQUIRE(
        hive_application_collect(application, R"(["probe"])", R"({"connection": {"transfer": "stream"}})", &collector)
        == HIVE_OK);
    REQUIRE(eventually([&] { return hive_output_wanted(output, &wanted) == HIVE_OK && wanted; }));
    making.result = HIVE_IO;
    CHECK(hive_output_emit_made(output, nullptr, 0, make, &making, nullptr) == HIVE_IO);
    CHECK(error() == "no film left");
    making = {.made = 0, .result = HIVE_OK, .give = false};
    CHECK(hive_output_emit_made(output, nullptr, 0, make, &making, nullptr) == HIVE_INVALID_ARGUMENT);
    making.give = true;
    CHECK(hive_output_emit_captured_made(output, 1'700'000'000'000'000, true, nullptr, 0, make, &making, nullptr)
          == HIVE_OK);
    CHECK(hive_output_emit_made(output, "{}", 2, make, &making, nullptr) == HIVE_OK);
    CHECK(making.made == 3);
    for (const auto captured : {std::int64_t{1'700'000'000'000'000}, std::int64_t{0}}) {
        auto* event = next(collector);
        CHECK(info_of(event).at("size") == 3);
        if (captured)
            CHECK(info_of(event).at("captured_us") == captured);
        hive_release(event);
    }
    hive_release(collector);
    hive_release(application);
    hive_release(output);
    hive_release(drone);
}

TEST_CASE("c: emitting on another thread than the one that runs the drone is refused")
{
    Pair pair(1);
    CHECK(hive_output_emit(pair.source.output, nullptr, 0, nullptr, 0, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(error().find("thread") != std::string::npos);
    hive_loan* loan = nullptr;
    CHECK(hive_output_loan(pair.source.output, 10, &loan) == HIVE_OK);
    hive_release(loan);
}
