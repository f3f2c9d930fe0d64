// What a drone binary says without running, and whether its page says the same.
#include "subject.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <unistd.h>

#include <fstream>
#include <map>
#include <regex>

using subject::Json;
using subject::written;

namespace {

std::string trimmed(const std::string& text)
{
    const auto first = text.find_first_not_of(" `"), last = text.find_last_not_of(" `");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/// The cells of a line of a table; `\|` is a bar inside a cell.
std::vector<std::string> cells_of(const std::string& line)
{
    std::vector<std::string> cells;
    std::string cell;
    for (std::size_t i = 1; i < line.size(); ++i)
        if (line[i] == '\\' && i + 1 < line.size() && line[i + 1] == '|')
            cell += line[++i];
        else if (line[i] == '|')
            cells.push_back(std::exchange(cell, {}));
        else
            cell += line[i];
    return cells;
}

/// The rows of the first table after a heading, without its two lines of head.
std::vector<std::vector<std::string>> table_under(const std::string& heading)
{
    std::ifstream page(subject::folder() / "README.md");
    std::string line;
    while (std::getline(page, line) && line != heading) {
    }
    std::vector<std::vector<std::string>> rows;
    while (std::getline(page, line) && !line.starts_with("## "))
        if (line.starts_with("|"))
            rows.push_back(cells_of(line));
        else if (!rows.empty())
            break;
    rows.erase(rows.begin(), rows.begin() + std::min<std::ptrdiff_t>(2, std::ssize(rows)));
    return rows;
}

std::string range_of(const Json& parameter)
{
    std::string text;
    for (const auto& choice : parameter.value("choices", Json::array()))
        text += (text.empty() ? "" : " | ") + choice.get<std::string>();
    if (parameter.contains("min") && parameter.contains("max"))
        return written(parameter["min"]) + " to " + written(parameter["max"]);
    if (parameter.contains("min"))
        return "at least " + written(parameter["min"]);
    return parameter.contains("max") ? "at most " + written(parameter["max"]) : text;
}

std::string default_of(const Json& parameter)
{
    const Json& value = parameter.at("default");
    if (value.is_boolean())
        return value.get<bool>() ? "on" : "off";
    return value.is_string() ? value.get<std::string>() : written(value.get<double>());
}

bool is_word_of_type(const std::string& type)
{
    return type == "integer" || type == "number" || type == "text" || type == "flag";
}

}  // namespace

TEST_CASE("drone: --describe prints the interface as JSON and nothing else, without a home and without a socket")
{
    const auto ended = subject::run_offline({"--describe"});
    CAPTURE(ended.output);
    REQUIRE(ended.exit_code == 0);
    const Json json = Json::parse(ended.output);
    CHECK(subject::program().filename() == "hive-" + json.at("kind").get<std::string>());
    CHECK_FALSE(json.at("summary").get<std::string>().empty());
    CHECK_FALSE(json.at("version").get<std::string>().empty());
    CHECK(json.at("stateful").is_boolean());
    for (const char* list : {"inputs", "outputs"})
        for (const auto& port : json.at(list)) {
            CHECK_FALSE(port.at("name").get<std::string>().empty());
            CHECK(port.at("type").get<std::string>().find('/') != std::string::npos);
            CHECK_FALSE(port.at("help").get<std::string>().empty());
        }
    CHECK(json.at("inputs").size() + json.at("outputs").size() > 0);
    for (const auto& parameter : json.at("parameters")) {
        CHECK(is_word_of_type(parameter.at("type")));
        CHECK(parameter.contains("default"));
        CHECK_FALSE(parameter.at("help").get<std::string>().empty());
    }
}

TEST_CASE("drone: a parameter that names a file, a host or a login is the operator's, not that of whoever has the key")
{
    static const std::regex of_the_machine(R"(\b(file|folder|path|host|address|password|login|token)(s|es)?\b)");
    for (const auto& parameter : subject::description().at("parameters")) {
        const auto help = parameter.at("help").get<std::string>();
        CAPTURE(parameter);
        if (parameter.at("type") == "text" && !parameter.contains("choices") && std::regex_search(help, of_the_machine))
            CHECK(parameter.value("operator", false));
    }
}

TEST_CASE("drone: the confinement of --describe is real: the same confinement kills a drone that runs")
{
    CHECK(subject::run_offline({"--name", "subject"}).exit_code != 0);
    const auto home = subject::run({subject::program(), "--name", "subject"}, {"HIVE_HOME=/dev/null/home"});
    CHECK(home.exit_code == 1);
    CHECK(home.output.find("/dev/null") != std::string::npos);
}

TEST_CASE("drone: --help and --version answer and end well; unknown flags and bad names do not")
{
    const auto help = subject::run_offline({"--help"});
    CHECK(help.exit_code == 0);
    for (const char* flag : {"--name", "--listen", "--set", "--connect", "--describe", "--on-exception", "--halted",
                             "--log-level", "--version"})
        CHECK_MESSAGE(help.output.find(flag) != std::string::npos, flag);
    const auto version = subject::run_offline({"--version"});
    CHECK(version.exit_code == 0);
    CHECK(trimmed(version.output).starts_with(subject::description().at("version").get<std::string>()));
    CHECK(subject::run_offline({"--no-such-flag"}).exit_code != 0);
    CHECK(subject::run_offline({"--name", "../subject"}).exit_code != 0);
    CHECK(subject::run_offline({"--set", "no-equals-sign"}).exit_code != 0);
}

TEST_CASE("drone: --connect with a mistake of form, or to an input that it has not, is refused in a sentence")
{
    for (const char* word : {"nonsense", "camera.image,widow=2", "camera.image,lease=2", "camera.image,at=nowhere"}) {
        const auto ended = subject::run_offline({"--connect", word});
        CHECK(ended.exit_code == 2);
        CHECK_MESSAGE(ended.output.find("--connect") != std::string::npos, ended.output);
    }
    // Which inputs there are is known when the drone has declared them; some look into the home before that.
    const auto home = std::filesystem::temp_directory_path() / ("hv-refused-" + std::to_string(::getpid()));
    const auto unknown =
        subject::run({subject::program(), "--connect", "no-such-input=camera.image"}, {"HIVE_HOME=" + home.string()});
    std::filesystem::remove_all(home);
    CHECK(unknown.exit_code == 3);
    CHECK_MESSAGE(unknown.output.find("--connect no-such-input=camera.image") != std::string::npos, unknown.output);
}

TEST_CASE("drone: the page lists exactly the parameters, with type, default, range, unit and help")
{
    const auto rows = table_under("## Parameters");
    const Json& parameters = subject::description().at("parameters");
    REQUIRE(rows.size() == parameters.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const Json& parameter = parameters[i];
        REQUIRE(rows[i].size() == 6);
        CAPTURE(parameter);
        CHECK(trimmed(rows[i][0]) == parameter.at("name"));
        CHECK(trimmed(rows[i][1]) == parameter.at("type"));
        CHECK(trimmed(rows[i][2]) == default_of(parameter));
        CHECK(trimmed(rows[i][3]) == range_of(parameter));
        CHECK(trimmed(rows[i][4]) == parameter.value("unit", ""));
        CHECK(trimmed(rows[i][5]) == trimmed(parameter.value("help", "")));
    }
}

TEST_CASE("drone: the page lists exactly the inputs and outputs, with their types")
{
    std::map<std::string, std::string> told, written_down;
    for (const auto& port : subject::description().at("inputs"))
        told["input `" + port.at("name").get<std::string>()] = port.at("type");
    for (const auto& port : subject::description().at("outputs"))
        told["output `" + port.at("name").get<std::string>()] = port.at("type");
    for (const auto& row : table_under("## Inputs and outputs")) {
        REQUIRE(row.size() == 3);
        CHECK(written_down.emplace(trimmed(row[0]), trimmed(row[1])).second);
    }
    CHECK(told == written_down);
}
