// Loads the libraries.
#include "avahi.hpp"

#include <cstdlib>
#include <dlfcn.h>
#include <string>
#include <unistd.h>

namespace hive::discovery {
namespace {

/// Looks functions up; remembers whether one was missing.
class Libraries {
public:
    template <class Function>
    void find(Function& function, const char* name)
    {
        void* found = nullptr;
        for (void* library : {common_, client_})
            if (library && !found)
                found = ::dlsym(library, name);
        function = reinterpret_cast<Function>(found);
        complete_ = complete_ && found;
    }
    [[nodiscard]] bool complete() const { return complete_; }

private:
    void* common_ = ::dlopen("libavahi-common.so.3", RTLD_NOW | RTLD_LOCAL);
    void* client_ = ::dlopen("libavahi-client.so.3", RTLD_NOW | RTLD_LOCAL);
    bool complete_ = true;
};

const Avahi* load()
{
    static Avahi all;
    Libraries libraries;
    libraries.find(all.client_new, "avahi_client_new");
    libraries.find(all.client_free, "avahi_client_free");
    libraries.find(all.client_errno, "avahi_client_errno");
    libraries.find(all.client_get_host_name, "avahi_client_get_host_name");
    libraries.find(all.client_get_local_service_cookie, "avahi_client_get_local_service_cookie");
    libraries.find(all.entry_group_new, "avahi_entry_group_new");
    libraries.find(all.entry_group_add_service_strlst, "avahi_entry_group_add_service_strlst");
    libraries.find(all.entry_group_update_service_txt_strlst, "avahi_entry_group_update_service_txt_strlst");
    libraries.find(all.entry_group_commit, "avahi_entry_group_commit");
    libraries.find(all.entry_group_reset, "avahi_entry_group_reset");
    libraries.find(all.service_browser_new, "avahi_service_browser_new");
    libraries.find(all.service_resolver_new, "avahi_service_resolver_new");
    libraries.find(all.service_resolver_free, "avahi_service_resolver_free");
    libraries.find(all.simple_poll_new, "avahi_simple_poll_new");
    libraries.find(all.simple_poll_get, "avahi_simple_poll_get");
    libraries.find(all.simple_poll_iterate, "avahi_simple_poll_iterate");
    libraries.find(all.simple_poll_wakeup, "avahi_simple_poll_wakeup");
    libraries.find(all.simple_poll_free, "avahi_simple_poll_free");
    libraries.find(all.string_list_new_from_array, "avahi_string_list_new_from_array");
    libraries.find(all.string_list_free, "avahi_string_list_free");
    libraries.find(all.address_snprint, "avahi_address_snprint");
    libraries.find(all.alternative_service_name, "avahi_alternative_service_name");
    libraries.find(all.free, "avahi_free");
    libraries.find(all.strerror, "avahi_strerror");
    return libraries.complete() ? &all : nullptr;
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
