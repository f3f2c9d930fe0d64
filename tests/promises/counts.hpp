// Where the tests of promises read a number or a word in a status or in a row of `hivectl connections --json`.
#pragma once

#include <swarm.hpp>

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace hive::test {

/// The whole status of a drone as it travels, whether the application gives it as JSON or as values.
template <class Asked = Application>
Json status_of(Asked& application, const std::string& drone)
{
    const auto status = application.status(drone);
    if constexpr (std::is_same_v<std::remove_const_t<decltype(status)>, Json>)
        return status;
    else
        return to_json(status);
}

/// Does the status contain this word, wherever it is?
inline bool says(Application& application, const std::string& drone, const std::string& word)
{
    return status_of(application, drone).dump().find('"' + word + '"') != std::string::npos;
}

inline std::int64_t number_in(const Json& object, const std::string& key)
{
    return object.contains(key) && object[key].is_number() ? object[key].get<std::int64_t>() : 0;
}

/// Over all inputs, those that were disconnected included: "received", "processed", "abandoned", "duplicates",
/// "discarded", "dropped".
inline std::int64_t total(Application& application, const std::string& drone, const std::string& key)
{
    const auto status = status_of(application, drone);
    if (status.contains("events"))
        return number_in(status["events"], key);
    std::int64_t sum = 0;
    for (const char* list : {"inputs", "left"})
        for (const auto& row : status.value(list, Json::array()))
            sum += number_in(row, key);
    return sum;
}

inline std::int64_t queued(Application& application, const std::string& drone)
{
    const auto status = status_of(application, drone);
    return status.contains("queued") ? number_in(status, "queued") : total(application, drone, "queued");
}

inline bool is_busy(Application& application, const std::string& drone)
{
    return status_of(application, drone).at("state") == "busy";
}

/// What the first output has given.
inline std::int64_t produced(Application& application, const std::string& drone)
{
    return number_in(status_of(application, drone).at("outputs").at(0), "produced");
}

/// The rows of those who are registered at an output.
inline std::vector<Json> registered(const Json& output)
{
    std::vector<Json> rows;
    for (const auto& row : output.value(output.contains("edges") ? "edges" : "receivers", Json::array()))
        if (output.contains("receivers") || row.value("connected", false))
            rows.push_back(row);
    return rows;
}

/// Of the first output.
inline std::vector<Json> receivers(Application& application, const std::string& drone)
{
    return registered(status_of(application, drone).at("outputs").at(0));
}

/// Is that drone connected to at least one sender?
inline bool is_connected(Application& application, const std::string& drone)
{
    const auto status = status_of(application, drone);
    for (const auto& row : status.at("inputs"))
        if (row.value("connected", false) || row.value("state", "") == "connected")
            return true;
    return false;
}

/// The rows of `hivectl connections --json`.
inline std::vector<Json> edges(const Swarm& swarm)
{
    return Json::parse(swarm.hivectl_done({"connections", "--json", "--timeout", "10"}));
}

/// What a row says came to the edge; nothing when it does not say.
inline std::optional<std::int64_t> came_to(const Json& edge)
{
    for (const char* key : {"came", "produced"})
        if (edge.contains(key) && edge[key].is_number())
            return edge[key].get<std::int64_t>();
    return std::nullopt;
}

/// What was dropped at either end of an edge, as its row says.
inline std::int64_t dropped_on(const Json& edge)
{
    std::int64_t sum = 0;
    for (const auto& [key, value] : edge.items())
        if (std::string_view(key).starts_with("dropped") && value.is_number())
            sum += value.get<std::int64_t>();
    return sum;
}

/// The same for the rate that an edge has in `hivectl top --json`.
inline bool is_dropping(const Json& edge)
{
    for (const auto& [key, value] : edge.items())
        if (std::string_view(key).starts_with("dropped") && value.is_number() && value.get<double>() > 0)
            return true;
    return false;
}

}  // namespace hive::test
