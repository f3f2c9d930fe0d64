// Reading and writing the words of a run.
#include "run.hpp"

#include <array>
#include <functional>
#include <map>
#include <stdexcept>

namespace hive::bench {
namespace {

constexpr std::array tests{"lat", "thr", "sync", "rpc"};

Test test_of(const std::string& text)
{
    for (std::size_t i = 0; i < tests.size(); ++i)
        if (text == tests[i])
            return static_cast<Test>(i);
    throw std::invalid_argument("a test is lat, thr, sync or rpc, not " + text);
}

using Setter = std::function<void(Run&, const std::string&)>;

const std::map<std::string, Setter>& setters()
{
    static const std::map<std::string, Setter> all{
        {"subscribers", [](Run& run, const std::string& value) { run.subscribers = std::stoi(value); }},
        {"frames", [](Run& run, const std::string& value) { run.frames = std::stoi(value); }},
        {"seconds", [](Run& run, const std::string& value) { run.seconds = std::stod(value); }},
        {"rate", [](Run& run, const std::string& value) { run.rate = std::stod(value); }},
        {"window", [](Run& run, const std::string& value) { run.window = std::stoi(value); }},
        {"busy", [](Run& run, const std::string& value) { run.busy = value == "1"; }},
        {"dial", [](Run& run, const std::string& value) { run.dial = value == "1"; }},
        {"timeout", [](Run& run, const std::string& value) { run.timeout = std::stod(value); }},
        {"role", [](Run& run, const std::string& value) { run.role = static_cast<Role>(std::stoi(value)); }},
        {"index", [](Run& run, const std::string& value) { run.index = std::stoi(value); }},
        {"place", [](Run& run, const std::string& value) { run.place = value; }},
        {"port", [](Run& run, const std::string& value) { run.port = static_cast<std::uint16_t>(std::stoi(value)); }},
    };
    return all;
}

}  // namespace

bool Run::is(const std::string& part) const
{
    return ("-" + variant + "-").find("-" + part + "-") != std::string::npos;
}

std::string to_text(Test test) { return tests[static_cast<std::size_t>(test)]; }

Run read_run(const std::string& program, const std::vector<std::string>& words)
{
    if (words.size() < 3)
        throw std::invalid_argument("usage: bench_" + program + " VARIANT lat|thr|sync|rpc SIZE [name=value]...");
    Run run;
    run.program = program;
    run.variant = words[0];
    run.test = test_of(words[1]);
    run.size = std::stoull(words[2]);
    for (std::size_t i = 3; i < words.size(); ++i) {
        const auto equals = words[i].find('=');
        const auto setter = setters().find(words[i].substr(0, equals));
        if (equals == std::string::npos || setter == setters().end())
            throw std::invalid_argument("unknown: " + words[i]);
        setter->second(run, words[i].substr(equals + 1));
    }
    if (run.size < 64 || run.subscribers < 1 || run.subscribers > 4 || run.frames < 2 || run.rate <= 0)
        throw std::invalid_argument("SIZE is at least 64, subscribers 1 to 4, frames at least 2, rate over 0");
    return run;
}

std::vector<std::string> words_of(const Run& run)
{
    return {run.variant,
            to_text(run.test),
            std::to_string(run.size),
            "subscribers=" + std::to_string(run.subscribers),
            "frames=" + std::to_string(run.frames),
            "seconds=" + std::to_string(run.seconds),
            "rate=" + std::to_string(run.rate),
            "window=" + std::to_string(run.window),
            "busy=" + std::to_string(run.busy),
            "dial=" + std::to_string(run.dial),
            "timeout=" + std::to_string(run.timeout),
            "role=" + std::to_string(static_cast<int>(run.role)),
            "index=" + std::to_string(run.index),
            "place=" + run.place,
            "port=" + std::to_string(run.port)};
}

}  // namespace hive::bench
