// Formats places.
#include "words/places.hpp"

#include "words/format.hpp"

#include <algorithm>
#include <chrono>

namespace hivectl {

std::string host_of(const std::string& address)
{
    const auto begin = address.find("//");
    const auto text = begin == std::string::npos ? address : address.substr(begin + 2);
    return text.substr(0, text.rfind(':'));
}

bool is_elsewhere(const hive::Place& place) { return !place.address.empty() && place.host != hive::Place::here; }

std::string place_text(const hive::Place& place)
{
    const bool says_it = place.address.find("//" + place.host + ":") != std::string::npos;
    return place.address + (says_it ? "" : " (" + place.host + ")");
}

std::string answered_text(const hive::Place& place)
{
    using namespace std::chrono;
    if (place.answered_us == 0)
        return "has not answered yet";
    const auto now_us = duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
    return "answered " + duration_text(std::max<std::int64_t>(now_us - place.answered_us, 0)) + " ago";
}

}  // namespace hivectl
