// Loads the functions.
#include "avahi.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <string>
#include <type_traits>
#include <unistd.h>

namespace hive::discovery {
namespace {

const Avahi* load()
{
    static Avahi all;
    void* const library = ::dlopen("libavahi-client.so.3", RTLD_NOW | RTLD_LOCAL);  // which brings libavahi-common
    bool complete = library;
    const auto find = [&](auto& function, const char* name) {
        void* const found = complete ? ::dlsym(library, name) : nullptr;
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(found);
        complete = found;
    };
#define HIVE_FIND(name) find(all.name, "avahi_" #name);
    HIVE_AVAHI_FUNCTIONS(HIVE_FIND)
#undef HIVE_FIND
    return complete ? &all : nullptr;
}

}  // namespace

const Avahi* avahi()
{
    static const Avahi* const loaded = load();
    return loaded;
}

bool has_system_bus()
{
    const char* address = std::getenv("DBUS_SYSTEM_BUS_ADDRESS");
    if (!address || *address == '\0')
        return ::access("/run/dbus/system_bus_socket", F_OK) == 0
               || ::access("/var/run/dbus/system_bus_socket", F_OK) == 0;
    const std::string text = address, path = "unix:path=";
    return !text.starts_with(path)
           || ::access(text.substr(path.size(), text.find(',') - path.size()).c_str(), F_OK) == 0;
}

}  // namespace hive::discovery
