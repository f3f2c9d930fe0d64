// The functions of places.
#include "application_object.hpp"

using namespace hive;
using namespace hive::c;

namespace {

Place place_of(const char* text)
{
    const Options read(required(text, "the place"), {"drone", "host", "address", "ssh", "answered_us"});
    return {.drone = read.text("drone"),
            .host = read.text("host"),
            .address = read.text("address"),
            .ssh = read.text("ssh"),
            .answered_us = read.integer("answered_us", 0, 0)};
}

}  // namespace

hive_code hive_application_place(hive_application* application, const char* drone, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        give_json(place_json(open.place(text_of(drone, "the drone"))), json, length);
    });
}

hive_code hive_application_places(hive_application* application, char** json, size_t* length)
{
    return with_application(application, [&](Application& open) {
        Json list = Json::array();
        for (const auto& place : open.listed_places())
            list.push_back(place_json(place));
        give_json(list, json, length);
    });
}

hive_code hive_application_add_place(hive_application* application, const char* place)
{
    return with_application(application, [&](Application& open) { open.add_place(place_of(place)); });
}

hive_code hive_application_forget_place(hive_application* application, const char* place)
{
    return with_application(application, [&](Application& open) {
        const auto wanted = place_of(place);
        if (!open.forget_place(wanted))
            throw Error(Errc::not_found, "no place of " + in_quotes(wanted.drone) + " is listed");
    });
}
