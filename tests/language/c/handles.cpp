// Handles that are null, released, invented, or of another kind: each function that takes one refuses it.
#include "world.hpp"

#include <hive_swarm.h>

#include <fstream>
#include <functional>
#include <map>
#include <mutex>
#include <regex>
#include <set>

using namespace world;

namespace {

/// Places for results; what is asked of a wrong handle never gets there.
struct Places {
    char* text = nullptr;
    const char* constant = nullptr;
    std::size_t size = 0;
    const void* bytes = nullptr;
    void* memory = nullptr;
    bool flag = false;
    int integer = 0;
    double number = 0;
    std::int64_t count = 0;
    hive_body* body = nullptr;
    hive_output* output = nullptr;
    hive_matching* matching = nullptr;
    hive_loan* loan = nullptr;
    hive_collector* collector = nullptr;
    hive_event* event = nullptr;
    hive_swarm* swarm = nullptr;
};

using Call = std::function<hive_code(void*)>;

hive_code nothing(void*) { return HIVE_OK; }
hive_code no_event(void*, const hive_event*) { return HIVE_OK; }
hive_code no_set(void*, const hive_event* const*, std::size_t) { return HIVE_OK; }
hive_code no_end(void*, const char*) { return HIVE_OK; }
hive_code no_body(void*, hive_body**) { return HIVE_OK; }
hive_code no_encoding(void*, const hive_event*, const char*, hive_encoded*) { return HIVE_OK; }
hive_code no_main(void*, std::int64_t*) { return HIVE_OK; }
void no_log(void*, const char*) {}
void no_leveled_log(void*, const char*, const char*) {}

#define ON(kind, function, ...)                                                                                        \
    {                                                                                                                  \
#function, [&p](void* h) { return function(static_cast<kind*>(h) __VA_OPT__(, ) __VA_ARGS__); }                \
    }

std::map<std::string, Call> calls_of_events(Places& p)
{
    return {ON(hive_event, hive_event_info, &p.text, &p.size),
            ON(hive_event, hive_event_number, "age_us", &p.count),
            ON(hive_event, hive_event_hop, 0, &p.constant, &p.count, &p.count),
            ON(hive_event, hive_event_header, &p.constant, &p.size),
            ON(hive_event, hive_event_bytes, &p.bytes, &p.size),
            ON(hive_event, hive_event_body, &p.body),
            ON(hive_event, hive_event_done),
            ON(hive_body, hive_body_bytes, &p.bytes, &p.size),
            ON(hive_body, hive_body_foreign, &p.flag),
            ON(hive_loan, hive_loan_bytes, &p.memory, &p.size),
            ON(hive_loan, hive_loan_body, 1, &p.body),
            ON(hive_matching, hive_matching_rule, nullptr),
            ON(hive_encoded, hive_encoded_give, nullptr, 0, nullptr),
            ON(hive_output, hive_output_wanted, &p.flag),
            ON(hive_output, hive_output_received, &p.flag),
            ON(hive_output, hive_output_asked, &p.flag),
            ON(hive_output, hive_output_loan, 1, &p.loan),
            ON(hive_output, hive_output_emit, nullptr, 0, nullptr, 0, nullptr),
            ON(hive_output, hive_output_emit_body, nullptr, 0, nullptr, nullptr),
            ON(hive_output, hive_output_emit_captured, 0, false, nullptr, 0, nullptr, nullptr),
            ON(hive_output, hive_output_emit_made, nullptr, 0, no_body, nullptr, nullptr),
            ON(hive_output, hive_output_emit_captured_made, 0, false, nullptr, 0, no_body, nullptr, nullptr),
            ON(hive_output, hive_output_fail, 0, false, HIVE_IO, "text"),
            ON(hive_output, hive_output_repeat, nullptr),
            ON(hive_output, hive_output_end, nullptr),
            ON(hive_output, hive_output_begin_source),
            ON(hive_collector, hive_collector_next, 0, &p.event),
            ON(hive_collector, hive_collector_next_set, 0, &p.event, 1, &p.size),
            ON(hive_collector, hive_collector_counts, &p.text, &p.size),
            ON(hive_collector, hive_collector_count, "received", &p.count),
            ON(hive_collector, hive_collector_inputs, &p.text, &p.size),
            ON(hive_collector, hive_collector_ended, &p.flag, &p.text),
            ON(hive_collector, hive_collector_close)};
}

std::map<std::string, Call> calls_of_drones(Places& p)
{
    return {ON(hive_drone, hive_drone_on_log, no_log, nullptr),
            ON(hive_drone, hive_drone_on_leveled_log, no_leveled_log, nullptr),
            ON(hive_drone, hive_drone_name, &p.text),
            ON(hive_drone, hive_drone_given, "x", &p.text, &p.flag),
            ON(hive_drone, hive_drone_parameter, R"({"name": "x", "type": "flag", "default": true})"),
            ON(hive_drone, hive_drone_integer, "i", &p.integer, nullptr, ""),
            ON(hive_drone, hive_drone_number, "n", &p.number, nullptr, ""),
            ON(hive_drone, hive_drone_flag, "f", &p.flag, nullptr, ""),
            ON(hive_drone, hive_drone_text, "t", &p.constant, nullptr, ""),
            ON(hive_drone, hive_drone_values, &p.text, &p.size),
            ON(hive_drone, hive_drone_assign, "{}"),
            ON(hive_drone, hive_drone_output, "o", "a/b", "", &p.output),
            ON(hive_drone, hive_drone_encoded_output, "p", "a/b", "", R"([{"word": "z", "type": "a/z"}])", no_encoding,
               nullptr, &p.output),
            ON(hive_drone, hive_drone_on_event, "e", "a/b", "", no_event, nullptr),
            ON(hive_drone, hive_drone_on_matched, "[]", nullptr, no_set, nullptr, nullptr, &p.matching),
            ON(hive_drone, hive_drone_on_change, nothing, nullptr),
            ON(hive_drone, hive_drone_on_start, nothing, nullptr),
            ON(hive_drone, hive_drone_on_end, no_end, nullptr),
            ON(hive_drone, hive_drone_main, no_main, nullptr),
            ON(hive_drone, hive_drone_describe, &p.text, &p.size),
            ON(hive_drone, hive_drone_run),
            ON(hive_drone, hive_drone_start),
            ON(hive_drone, hive_drone_step, 1, &p.flag),
            ON(hive_drone, hive_drone_end),
            ON(hive_drone, hive_drone_wake),
            ON(hive_drone, hive_drone_stop),
            ON(hive_drone, hive_drone_condition, "", ""),
            ON(hive_drone, hive_drone_source_events, 1),
            ON(hive_drone, hive_drone_report, HIVE_IO, "text"),
            ON(hive_drone, hive_drone_log, "text"),
            ON(hive_drone, hive_drone_log_at, "info", "text"),
            ON(hive_drone, hive_drone_stopping, &p.flag),
            ON(hive_drone, hive_drone_status, &p.text, &p.size)};
}

std::map<std::string, Call> calls_of_applications(Places& p)
{
    return {ON(hive_application, hive_application_close),
            ON(hive_application, hive_application_name, &p.text),
            ON(hive_application, hive_application_timeout, 1000),
            ON(hive_application, hive_application_drones, &p.text, &p.size),
            ON(hive_application, hive_application_remembered, &p.text, &p.size),
            ON(hive_application, hive_application_find, "*", &p.text, &p.size),
            ON(hive_application, hive_application_describe, "x", &p.text, &p.size),
            ON(hive_application, hive_application_status, "x", &p.text, &p.size),
            ON(hive_application, hive_application_status_all, "[]", &p.text, &p.size),
            ON(hive_application, hive_application_place, "x", &p.text, &p.size),
            ON(hive_application, hive_application_places, &p.text, &p.size),
            ON(hive_application, hive_application_add_place, "{}"),
            ON(hive_application, hive_application_forget_place, "{}"),
            ON(hive_application, hive_application_wait, "x", "running", 0),
            ON(hive_application, hive_application_connect, "x", "y", nullptr, &p.text),
            ON(hive_application, hive_application_disconnect, "x", "y"),
            ON(hive_application, hive_application_set, "x", "{}", &p.text),
            ON(hive_application, hive_application_set_all, "[]", "{}", nothing, nullptr, &p.text),
            ON(hive_application, hive_application_get, "x", nullptr, &p.text),
            ON(hive_application, hive_application_get_all, "[]", nullptr, &p.text),
            ON(hive_application, hive_application_collect, R"(["x"])", nullptr, &p.collector),
            ON(hive_application, hive_application_collect_matched, R"(["x","y"])", nullptr, nullptr, &p.collector),
            ON(hive_application, hive_application_exceptions, R"(["x"])", &p.collector),
            ON(hive_application, hive_application_put, "x.y", nullptr, 0, nullptr, 0, "a/b"),
            ON(hive_application, hive_application_halt, "x"),
            ON(hive_application, hive_application_resume, "x"),
            ON(hive_application, hive_application_stop, "x"),
            ON(hive_application, hive_application_start, "x", nullptr, &p.text),
            ON(hive_application, hive_application_explain, R"(["x"])", &p.text, &p.size),
            ON(hive_application, hive_application_advise, R"(["x"])", nullptr, &p.text, &p.size),
            ON(hive_application, hive_application_audit, &p.text, &p.size),
            ON(hive_application, hive_application_graph, &p.text, &p.size),
            ON(hive_application, hive_application_metrics, &p.text, &p.size),
            ON(hive_application, hive_application_failures, "x", &p.text, &p.size),
            ON(hive_application, hive_application_rerun, "x", 0, nullptr, &p.text, &p.size),
            ON(hive_application, hive_application_exception_policy, "x", "skip"),
            ON(hive_application, hive_application_replace, "x", nullptr, &p.text),
            ON(hive_application, hive_swarm_open, "{}", R"({"form_only": true})", &p.swarm),
            ON(hive_application, hive_swarm_remembered, &p.text, &p.size),
            ON(hive_application, hive_swarm_running, nullptr, nullptr, &p.text, &p.size)};
}

std::map<std::string, Call> calls_of_swarms(Places& p)
{
    return {ON(hive_swarm, hive_swarm_close),
            ON(hive_swarm, hive_swarm_export, "shell", nullptr, &p.text, &p.size),
            ON(hive_swarm, hive_swarm_differences, &p.text, &p.size),
            ON(hive_swarm, hive_swarm_up, 1000, nullptr, nullptr, &p.text, &p.size),
            ON(hive_swarm, hive_swarm_down, 1000, nullptr, nullptr, &p.text, &p.size),
            ON(hive_swarm, hive_swarm_stay, no_end, nullptr)};
}

#undef ON

std::map<std::string, Call> all_calls(Places& places)
{
    auto all = calls_of_events(places);
    all.merge(calls_of_drones(places));
    all.merge(calls_of_applications(places));
    all.merge(calls_of_swarms(places));
    return all;
}

std::string text_of_headers()
{
    std::string text;
    for (const char* name : {"hive.h", "hive_swarm.h"}) {
        std::ifstream file(std::string(HIVE_SOURCE_DIR) + "/libhive/include/" + name);
        text.append(std::istreambuf_iterator<char>(file), {});
    }
    return text;
}

/// The functions whose first argument is a handle, as the headers declare them.
std::set<std::string> declared_with_handles()
{
    const auto header = text_of_headers();
    const std::regex pattern(R"((hive_[a-z_]+)\((const )?hive_[a-z]+\* [a-z]+[,)])");
    std::set<std::string> names;
    for (std::sregex_iterator found(header.begin(), header.end(), pattern), end; found != end; ++found)
        names.insert((*found)[1]);
    return names;
}

/// Each but those that have nothing to do any more.
void check_stopped(const std::map<std::string, Call>& calls, void* handle)
{
    for (const auto& each : calls) {
        const auto& name = each.first;  // clang 14 captures no bindings
        const auto& call = each.second;
        CAPTURE(name);
        if (!name.ends_with("_close") && name != "hive_application_name")
            CHECK(call(handle) == HIVE_STOPPED);
    }
}

}  // namespace

TEST_CASE("c: every function with a handle refuses null, invented, released and foreign ones")
{
    const Home home;
    Places places;
    const auto calls = all_calls(places);
    std::set<std::string> names;
    for (const auto& [name, call] : calls)
        names.insert(name);
    CHECK(names == declared_with_handles());

    hive_body *foreign = nullptr, *released = nullptr;
    REQUIRE(hive_body_new("x", 1, &foreign) == HIVE_OK);
    REQUIRE(hive_body_new("x", 1, &released) == HIVE_OK);
    REQUIRE(hive_release(released) == HIVE_OK);
    auto* drone = new_drone("probe");
    for (const auto& each : calls) {
        const auto& name = each.first;
        const auto& call = each.second;
        CAPTURE(name);
        CHECK(call(nullptr) == HIVE_INVALID_ARGUMENT);
        CHECK(call(&places) == HIVE_INVALID_ARGUMENT);
        CHECK(call(released) == HIVE_INVALID_ARGUMENT);
        const bool of_body = name.starts_with("hive_body_");
        CHECK(call(of_body ? static_cast<void*>(drone) : foreign) == HIVE_INVALID_ARGUMENT);
        CHECK(error().find("this is no hive_") != std::string::npos);
    }
    CHECK(hive_release(released) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_retain(released) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_retain(nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_release(nullptr) == HIVE_OK);
    CHECK(hive_release(drone) == HIVE_OK);
    CHECK(hive_release(foreign) == HIVE_OK);
}

TEST_CASE("c: a handle lives until its last reference is released, and none is left over")
{
    const auto before = hive_handle_count();
    hive_body* body = nullptr;
    REQUIRE(hive_body_new("abc", 3, &body) == HIVE_OK);
    CHECK(hive_retain(body) == HIVE_OK);
    CHECK(hive_release(body) == HIVE_OK);
    const void* bytes = nullptr;
    std::size_t size = 0;
    CHECK(hive_body_bytes(body, &bytes, &size) == HIVE_OK);
    CHECK(std::string(static_cast<const char*>(bytes), size) == "abc");
    CHECK(hive_handle_count() == before + 1);
    CHECK(hive_release(body) == HIVE_OK);
    CHECK(hive_handle_count() == before);
}

namespace {

/// The lines of a log, each with its level if it has one; also from other threads.
struct LogLines {
    static void plain(void* self, const char* line) { static_cast<LogLines*>(self)->add(line); }
    static void leveled(void* self, const char* level, const char* line)
    {
        static_cast<LogLines*>(self)->add(std::string(level) + " " + line);
    }
    void add(std::string line)
    {
        const std::lock_guard lock(mutex);
        lines.push_back(std::move(line));
    }
    std::mutex mutex;
    std::vector<std::string> lines;
};

/// What a callback gets of a drone that writes a line at each level and one at none.
std::vector<std::string> logged(const std::function<hive_code(hive_drone*, LogLines&)>& listen)
{
    const Home home;
    LogLines log;
    auto* drone = new_drone("probe");
    REQUIRE(listen(drone, log) == HIVE_OK);
    CHECK(hive_drone_log(drone, "plain") == HIVE_OK);
    for (const char* level : {"debug", "info", "warning", "error"})
        CHECK(hive_drone_log_at(drone, level, "text") == HIVE_OK);
    for (const char* level : {"loud", "off", static_cast<const char*>(nullptr)})
        CHECK(hive_drone_log_at(drone, level, "text") == HIVE_INVALID_ARGUMENT);
    hive_release(drone);
    return log.lines;
}

}  // namespace

TEST_CASE("c: a log line has its level for the callback that asks for it, and the other callback gets all lines")
{
    using Lines = std::vector<std::string>;
    CHECK(logged([](auto* drone, auto& log) { return hive_drone_on_leveled_log(drone, LogLines::leveled, &log); })
          == Lines{"info plain", "debug text", "info text", "warning text", "error text"});
    CHECK(logged([](auto* drone, auto& log) { return hive_drone_on_log(drone, LogLines::plain, &log); })
          == Lines{"plain", "text", "text", "text", "text"});
    CHECK(logged([](auto* drone, auto& log) {
              hive_drone_on_leveled_log(drone, LogLines::leveled, &log);
              return hive_drone_on_log(drone, nullptr, nullptr);
          }).empty());
}

TEST_CASE("c: the memory of the caller is given back when the last body over it is gone, and not on failure")
{
    static int freed;
    freed = 0;
    const auto count = [](void* user) { *static_cast<int*>(user) += 1; };
    hive_body* body = nullptr;
    CHECK(hive_body_over("abc", 3, count, &freed, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_body_over(nullptr, 3, count, &freed, &body) == HIVE_INVALID_ARGUMENT);
    CHECK(freed == 0);
    REQUIRE(hive_body_over("abc", 3, count, &freed, &body) == HIVE_OK);
    CHECK(freed == 0);
    hive_release(body);
    CHECK(freed == 1);
}

TEST_CASE("c: an application that is closed says so, and so do its collectors; a drone that was released as well")
{
    const Home home;
    auto* source = new_drone("source");
    hive_output* output = nullptr;
    REQUIRE(hive_drone_output(source, "out", "a/b", "", &output) == HIVE_OK);
    Places places;
    {
        Running running(source);
        auto* application = new_application();
        await(application, "source");
        hive_collector* collector = nullptr;
        REQUIRE(hive_application_collect(application, R"(["source.out"])", nullptr, &collector) == HIVE_OK);
        hive_swarm *swarm = nullptr, *closed = nullptr;
        const char* const file = R"({"swarm": "one", "drones": {"source": {"kind": "source"}}})";
        for (auto* place : {&swarm, &closed})
            REQUIRE(hive_swarm_open(application, file, R"({"form_only": true})", place) == HIVE_OK);
        CHECK(hive_swarm_close(closed) == HIVE_OK);
        check_stopped(calls_of_swarms(places), closed);
        CHECK(hive_application_close(application) == HIVE_OK);
        check_stopped(calls_of_swarms(places), swarm);
        hive_release(swarm);
        hive_release(closed);
        CHECK(hive_application_close(application) == HIVE_OK);
        check_stopped(calls_of_applications(places), application);
        hive_event* event = nullptr;
        CHECK(hive_collector_next(collector, 0, &event) == HIVE_STOPPED);
        CHECK(hive_collector_close(collector) == HIVE_OK);
        hive_release(application);
        CHECK(hive_collector_next(collector, 0, &event) == HIVE_STOPPED);
        hive_release(collector);
        running.end();
    }
    CHECK(hive_output_emit(output, nullptr, 0, nullptr, 0, nullptr) == HIVE_STOPPED);
    bool wanted = false;
    CHECK(hive_output_wanted(output, &wanted) == HIVE_STOPPED);
    hive_release(output);
    hive_free(places.text);
}
