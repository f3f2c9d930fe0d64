// Whole swarms in C, with real drones: everything or nothing, whoever cancels it and however.
#include "lab.hpp"

#include <fstream>

#include <csignal>

using namespace world;

TEST_CASE("c: a swarm file is checked, with line, column, text and advice of each mistake, and so is what is asked")
{
    const Lab lab;
    Text text;
    const char* const file = R"({
  "swarm": "a",
  "drones": {
    "source": {"kind": "ticker", "set": {"fsp": 3}},
    "far": {"kind": "nowhere-else", "on": "cam1"}
  },
  "connections": [{"from": "source", "to": "sink"}]
})";
    REQUIRE(hive_swarm_check(file, nullptr, text.place(), nullptr) == HIVE_OK);
    const auto mistakes = text.json().at("mistakes");
    REQUIRE_MESSAGE(mistakes.size() == 2, text.text());
    CHECK(mistakes[0].at("at") == "drones.source.set.fsp");
    CHECK(mistakes[0].at("line") == 4);
    CHECK(mistakes[0].at("column") == 42);
    CHECK(mistakes[0].at("text").get<std::string>().find("fsp") != std::string::npos);
    CHECK(mistakes[0].at("advice").get<std::string>().find("fps") != std::string::npos);
    CHECK(mistakes[1].at("line") == 7);
    CHECK(text.json().at("notes").size() == 1);
    REQUIRE(hive_swarm_check(file, R"({"form_only": true})", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("mistakes").size() == 1);

    hive_swarm* none = nullptr;
    CHECK(hive_swarm_open(lab.application, file, nullptr, &none) == HIVE_INVALID_ARGUMENT);
    CHECK(error().find("4:42: ") == 0);
    CHECK(error().find("(and 1 more mistake)") != std::string::npos);
    CHECK(hive_swarm_open(lab.application, nullptr, nullptr, &none) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_swarm_open(lab.application, "{}", R"({"from_only": true})", &none) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_swarm_open(lab.application, "{}", nullptr, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(none == nullptr);
    CHECK(hive_swarm_check(nullptr, nullptr, text.place(), nullptr) == HIVE_INVALID_ARGUMENT);

    REQUIRE(hive_swarm_schema(text.place(), nullptr) == HIVE_OK);
    std::ifstream schema(HIVE_SOURCE_DIR "/libhive/manager/swarm.schema.json");
    CHECK(text.json() == Json::parse(schema));
}

TEST_CASE("c: up makes what the file says, again it finds nothing to do, a change is one step, and down ends it")
{
    const Lab lab;
    auto content = workers_file(2);
    {
        const File file(lab, content);
        Text text;
        REQUIRE(hive_swarm_differences(file.handle, text.place(), nullptr) == HIVE_OK);
        const auto planned = File::words(text.json());
        CHECK(planned.size() == 5);
        std::size_t told = 0;
        const auto outcome = file.up([&](std::size_t done, std::size_t all, const std::string& what) {
            told += done <= all && (what == "started" || what == "wired");
            return true;
        });
        CHECK(File::words(outcome.at("steps")) == planned);
        CHECK(told >= planned.size());
        CHECK(outcome.at("steps").at(3).at("sender") == "source.tick");
        CHECK(outcome.at("steps").at(3).at("receiver") == "worker-1.image");
        CHECK(outcome.at("steps").at(3).at("options").at("group") == "source");
        CHECK(lab.drones() == std::vector<std::string>{"source", "worker-1", "worker-2"});
        CHECK(file.done().empty());
    }
    const auto before = lab.pid("worker-1");
    content["drones"]["source"]["set"]["bytes"] = 200;
    const File changed(lab, content);
    const auto steps = changed.up().at("steps");
    CHECK(File::words(steps) == std::vector<std::string>{"set source bytes=200"});
    CHECK(steps.at(0).at("before") == Json{{"bytes", 100}});
    CHECK(steps.at(0).at("values") == Json{{"bytes", 200}});
    CHECK(lab.pid("worker-1") == before);

    const auto remembered = lab.remembered();
    REQUIRE(remembered.size() == 1);
    CHECK(remembered.at(0).at("swarm") == "work");
    Text text;
    REQUIRE(hive_swarm_running(lab.application, nullptr, nullptr, text.place(), nullptr) == HIVE_OK);
    CHECK(File(lab, text.json()).done().empty());
    REQUIRE(hive_swarm_running(lab.application, "part", R"(["source"])", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("swarm") == "part");
    CHECK(text.json().at("drones").size() == 1);

    const File again(lab, Json::parse(remembered.at(0).at("text").get<std::string>()));
    CHECK(again.down().size() == 3);
    CHECK(leaves_nothing(lab, again));
}

TEST_CASE("c: when the last drone of a file does not start, nothing is left of the others")
{
    const Lab lab;
    auto content = workers_file(2);
    content["drones"]["zlast"] = {{"kind", "ticker"}, {"listen", "tcp://192.0.2.1"}, {"insecure", true}};
    const auto failed = failure(File(lab, content).up());
    CHECK(failed.at("drone") == "zlast");
    CHECK_MESSAGE(failed.at("error").at("text").get<std::string>().find("192.0.2.1") != std::string::npos, failed);
    CHECK(!failed.at("error").at("code").get<std::string>().empty());
    CHECK(lab.is_empty());
}

TEST_CASE("c: a program whose children the system reaps brings up a swarm, and is told when a drone does not start")
{
    const Lab lab;
    auto content = workers_file(2);
    const File file(lab, content);
    content["drones"]["zlast"] = {{"kind", "ticker"}, {"listen", "tcp://192.0.2.1"}, {"insecure", true}};
    const File other(lab, content);
    struct Reaped {
        decltype(::signal(SIGCHLD, SIG_IGN)) before = ::signal(SIGCHLD, SIG_IGN);
        ~Reaped() { ::signal(SIGCHLD, before); }
    } const reaped;
    CHECK(failure(other.up()).at("drone") == "zlast");
    CHECK(lab.is_empty());
    CHECK(file.done().size() == 5);
    CHECK(file.down().size() == 3);
}

TEST_CASE("c: who cancels while drones are started leaves none, by hive_on_wait or by the callback of the progress")
{
    const Lab lab;
    const File file(lab, workers_file(20));
    bool cancelled = false;
    REQUIRE(hive_on_wait(cancels_when_set, &cancelled) == HIVE_OK);
    for (const std::size_t moment : {3, 21}) {  // while some are not ready, and when all are
        const auto waited = failure(file.up([&](std::size_t done, std::size_t, const std::string&) {
            cancelled = done >= moment;
            return true;
        }));
        CHECK(waited.at("error").at("code") == "stopped");
        cancelled = false;
        CHECK(lab.is_empty());
        const auto told =
            failure(file.up([&](std::size_t done, std::size_t, const std::string&) { return done < moment; }));
        CHECK(told.at("error").at("code") == "stopped");
        CHECK(lab.is_empty());
    }
    CHECK(file.done().size() == 41);
    cancelled = true;  // in a hurry: events on their way are not waited for
    CHECK(file.down().size() == 21);
    cancelled = false;
    CHECK(leaves_nothing(lab, file));
}

TEST_CASE("c: who cancels while drones are set has the old values back, though hive_on_wait goes on to say so")
{
    const Lab lab;
    auto content = workers_file(3);
    content["drones"]["worker"]["set"]["work_ms"] = 200;  // so that a set has to wait
    const auto before = content;
    REQUIRE(File(lab, content).done().size() == 7);
    content["drones"]["worker"]["set"]["work_ms"] = 201;
    content["connections"][0]["window"] = 4;
    bool cancelled = false;
    REQUIRE(hive_on_wait(cancels_when_set, &cancelled) == HIVE_OK);
    const File changed(lab, content);
    const auto outcome = changed.up([&](std::size_t done, std::size_t all, const std::string& what) {
        cancelled = what == "wired" && done == all / 2;  // the connections are made at once
        return true;
    });
    cancelled = false;
    CHECK(failure(outcome).at("error").at("code") == "stopped");
    CHECK(lab.get("worker-1", "work_ms") == 200);
    CHECK(lab.get("worker-3", "work_ms") == 200);
    CHECK(File(lab, before).done().empty());
    CHECK(File(lab, content).done().size() == 6);
}

TEST_CASE("c: whoever stays with a swarm starts again what falls, until it is told to leave or the swarm is closed")
{
    const Lab lab;
    auto content = workers_file(1);
    content["drones"]["worker"] = {{"kind", "sleeper"}, {"restart", "on-failure"}};
    content["connections"][0] = {{"from", "source"}, {"to", "worker"}};
    const File file(lab, content);
    REQUIRE(file.done().size() == 3);
    struct Told {
        std::vector<std::string> texts;
        hive_code code = HIVE_OK;
    } told;
    const auto hear = [](void* user, const char* text) -> hive_code {
        auto& heard = *static_cast<Told*>(user);
        heard.texts.emplace_back(text);
        return heard.code == HIVE_OK ? HIVE_OK : hive_fail(heard.code, "that is enough");
    };
    const auto before = lab.pid("worker");
    ::kill(static_cast<pid_t>(before), SIGKILL);
    told.code = HIVE_REFUSED;
    CHECK(hive_swarm_stay(file.handle, nullptr, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_swarm_stay(file.handle, hear, &told) == HIVE_REFUSED);
    CHECK(error() == "that is enough");
    REQUIRE(told.texts.size() == 1);
    CHECK_MESSAGE(told.texts[0].find("worker crashed and was restarted") == 0, told.texts[0]);
    CHECK(lab.pid("worker") != before);

    static int asked;
    asked = 0;
    hive_on_wait([](void*) -> hive_code { return ++asked > 3 ? HIVE_FAILED : HIVE_OK; }, nullptr);
    CHECK(hive_swarm_stay(file.handle, hear, &told) == HIVE_STOPPED);
    hive_on_wait(nullptr, nullptr);
    CHECK(file.down().size() == 2);

    const File other(lab, workers_file(1));
    std::atomic<hive_code> left = -1;
    std::thread stays([&] { left = hive_swarm_stay(other.handle, hear, &told); });
    CHECK(hive_swarm_close(other.handle) == HIVE_OK);
    CHECK(eventually([&] { return left == HIVE_STOPPED; }));
    stays.join();
    std::thread again([&] { left = hive_swarm_stay(file.handle, hear, &told); });
    CHECK(hive_application_close(lab.application) == HIVE_OK);
    again.join();
    CHECK(left == HIVE_STOPPED);
}

TEST_CASE("c: a swarm is written for what is to run it")
{
    const Lab lab;
    const File file(lab, workers_file(2));
    Text text;
    REQUIRE(hive_swarm_export(file.handle, "shell", nullptr, text.place(), nullptr) == HIVE_OK);
    REQUIRE(text.json().size() == 1);
    CHECK(text.json().at(0).at("program") == true);
    CHECK(text.json().at(0).at("text").get<std::string>().find("hivectl connect source") != std::string::npos);
    REQUIRE(hive_swarm_export(file.handle, "systemd", R"({"programs": "/opt/hive"})", text.place(), nullptr)
            == HIVE_OK);
    CHECK(text.json().size() == 4);
    CHECK(text.text().find("/opt/hive/hive-ticker") != std::string::npos);
    CHECK(hive_swarm_export(file.handle, "cron", nullptr, text.place(), nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(hive_swarm_export(file.handle, "shell", R"({"iamge": "x"})", text.place(), nullptr) == HIVE_INVALID_ARGUMENT);
}

TEST_CASE("c: a drone is started and stopped, one that does not start says why, and so does one that gives nothing")
{
    const Lab lab;
    Text text;
    const auto start = [&](const char* kind, const Json& options) {
        return hive_application_start(lab.application, kind, options.dump().c_str(), text.place());
    };
    const auto ready_ms = patient(long_timeout).count();
    REQUIRE_MESSAGE(start("ticker", {{"name", "source"}, {"parameters", {{"pace", "demand"}}}, {"ready_ms", ready_ms}})
                        == HIVE_OK,
                    error());
    CHECK(text.json().at("drone") == "source");
    CHECK(text.json().at("host") == "local");
    CHECK(lab.get("source", "pace") == "demand");
    CHECK(start("ticker", {{"name", "source"}}) == HIVE_NAME_TAKEN);
    CHECK(start("no-such-kind", Json::object()) == HIVE_NOT_FOUND);
    CHECK(start("sleeper", {{"parameters", {{"work_ms", -1}}}}) == HIVE_REFUSED);
    CHECK_MESSAGE(error().find("work_ms") != std::string::npos, error());
    CHECK(start("sleeper", {{"knid", "x"}}) == HIVE_INVALID_ARGUMENT);
    REQUIRE(start("sleeper", {{"name", "worker"}, {"ready_ms", ready_ms}}) == HIVE_OK);
    REQUIRE(hive_application_connect(lab.application, "source", "worker", nullptr, nullptr) == HIVE_OK);
    const auto advise = [&](const char* drones, const char* options) {
        return hive_application_advise(lab.application, drones, options, text.place(), nullptr);
    };
    REQUIRE(advise("[]", R"({"goal":"latency","time_ms":300})") == HIVE_OK);
    CHECK(text.json().at("goal") == "latency");
    CHECK(text.json().at("lines").at(0).at("to") == "worker");
    CHECK(advise(nullptr, nullptr) == HIVE_INVALID_ARGUMENT);
    CHECK(advise("[]", R"({"goal":"colour"})") == HIVE_INVALID_ARGUMENT);
    CHECK(advise(R"(["nobody"])", nullptr) == HIVE_NOT_FOUND);
    REQUIRE(hive_application_halt(lab.application, "source") == HIVE_OK);
    REQUIRE(hive_application_explain(lab.application, R"(["worker.result"])", text.place(), nullptr) == HIVE_OK);
    CHECK_MESSAGE(text.json().at("text").get<std::string>().find("source has halted") != std::string::npos,
                  text.text());
    const auto between = [&](const char* pair) {
        return hive_application_explain(lab.application, pair, text.place(), nullptr);
    };
    REQUIRE(between(R"({"sender":"worker","receiver":"source"})") == HIVE_OK);
    CHECK(text.json().at("causes").at(0).at("what") == "wrong_way");
    CHECK(between(R"({"sender":"worker"})") == HIVE_INVALID_ARGUMENT);
    CHECK(hive_application_explain(lab.application, nullptr, text.place(), nullptr) == HIVE_INVALID_ARGUMENT);
    REQUIRE(hive_application_audit(lab.application, text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("clean") == true);
    CHECK(text.json().at("connections").at(0).at("verdict") == "ok");
    REQUIRE(hive_application_graph(lab.application, text.place(), nullptr) == HIVE_OK);
    CHECK(text.json().at("drones").size() == 2);
    CHECK(text.json().at("connections").at(0).at("to") == "worker.image");
    std::size_t length = 0;
    REQUIRE(hive_application_metrics(lab.application, text.place(), &length) == HIVE_OK);
    CHECK(length == text.text().size());
    const auto up = text.json().at(0);
    CHECK(up.at("name") == "hive_drone_up");
    CHECK(up.at("type") == "gauge");
    CHECK(up.at("samples").size() == 2);
    CHECK(up.at("samples").at(0) == Json{{"labels", {{"drone", "source"}, {"host", "local"}}}, {"value", 1.0}});
    REQUIRE(hive_application_failures(lab.application, "worker", text.place(), nullptr) == HIVE_OK);
    CHECK(text.json() == Json::array());
    const auto rerun = [&](const char* drone, const char* options) {
        return hive_application_rerun(lab.application, drone, 0, options, text.place(), nullptr);
    };
    CHECK(rerun("worker", nullptr) == HIVE_NOT_FOUND);
    CHECK(rerun("./missing.failure", nullptr) == HIVE_IO);
    CHECK(rerun("worker", R"({"on": "-oProxyCommand=x"})") == HIVE_INVALID_ARGUMENT);
    for (const char* drone : {"source", "worker"})
        CHECK(hive_application_stop(lab.application, drone) == HIVE_OK);
    CHECK(eventually([&] { return hive_application_stop(lab.application, "source") != HIVE_OK && lab.is_empty(); }));
}

TEST_CASE("c: a new process takes over from a drone, and when it does not get ready the error has the end of its log")
{
    const Lab lab;
    auto content = workers_file(1);
    content["drones"]["count"] = {{"kind", "counter"}};
    const File file(lab, content);
    REQUIRE(file.done().size() == 4);
    const auto before = lab.pid("worker-1");
    Text text;
    const auto replace = [&](const char* drone, const Json& options) {
        return hive_application_replace(lab.application, drone, options.dump().c_str(), text.place());
    };
    const auto ready_ms = patient(long_timeout).count();
    REQUIRE_MESSAGE(replace("worker-1", {{"parameters", {{"most_ms", 100}}}, {"ready_ms", ready_ms}}) == HIVE_OK,
                    error());
    CHECK(text.json().at("drone") == "worker-1");
    CHECK(lab.pid("worker-1") != before);
    CHECK(lab.get("worker-1", "work_ms") == 1);
    CHECK(lab.get("worker-1", "most_ms") == 100);
    const auto now = lab.pid("worker-1");
    CHECK(replace("worker-1", {{"listen", "tcp://127.0.0.1:1"}, {"ready_ms", ready_ms}}) == HIVE_REFUSED);
    CHECK_MESSAGE(error().find("swarm key") != std::string::npos, error());
    CHECK(lab.pid("worker-1") == now);
    CHECK(replace("count", Json::object()) == HIVE_REFUSED);
    CHECK(replace("count", {{"lose_state", true}, {"ready_ms", ready_ms}}) == HIVE_OK);
    CHECK(replace("nobody", Json::object()) == HIVE_NOT_FOUND);
    CHECK(replace("worker-1", {{"knid", "x"}}) == HIVE_INVALID_ARGUMENT);
    CHECK(file.down().size() == 3);
    CHECK(leaves_nothing(lab, file));
}

TEST_CASE("c: a drone that hangs is replaced only with force, and the new one has its parameters and connections")
{
    const Lab lab;
    const File file(lab, workers_file(1));
    REQUIRE(file.done().size() == 3);
    const auto before = lab.pid("worker-1");
    ::kill(static_cast<pid_t>(before), SIGSTOP);
    Text text;
    const auto replace = [&](hive_application* application, const Json& options) {
        return hive_application_replace(application, "worker-1", options.dump().c_str(), text.place());
    };
    hive_application* hasty = nullptr;
    REQUIRE(hive_application_new(Json{{"home", lab.swarm.home()}, {"timeout_ms", 1000}}.dump().c_str(), &hasty)
            == HIVE_OK);
    CHECK(replace(hasty, Json::object()) == HIVE_TIMEOUT);
    hive_release(hasty);
    CHECK(::kill(static_cast<pid_t>(before), 0) == 0);
    const Json options{
        {"force", true}, {"parameters", {{"most_ms", 100}}}, {"ready_ms", patient(long_timeout).count()}};
    REQUIRE_MESSAGE(replace(lab.application, options) == HIVE_OK, error());
    CHECK(text.json().at("drone") == "worker-1");
    CHECK(lab.pid("worker-1") != before);
    CHECK(lab.get("worker-1", "work_ms") == 1);
    CHECK(lab.get("worker-1", "most_ms") == 100);
    const auto processed = [&] {
        Text status;
        REQUIRE(hive_application_status(lab.application, "worker-1", status.place(), nullptr) == HIVE_OK);
        return status.json().at("inputs").at(0).value("processed", std::int64_t{0});  // left out while it is 0
    };
    CHECK(eventually([&] { return processed() > 0; }));
    CHECK(file.down().size() == 2);
    CHECK(leaves_nothing(lab, file));
}
