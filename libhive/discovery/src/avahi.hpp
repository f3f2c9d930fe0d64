// The used functions of libavahi-client and libavahi-common, loaded from the libraries of this machine if it has them.
#pragma once

#include <avahi-client/client.h>
#include <avahi-client/lookup.h>
#include <avahi-client/publish.h>
#include <avahi-common/address.h>
#include <avahi-common/alternative.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <avahi-common/simple-watch.h>
#include <avahi-common/strlst.h>

namespace hive::discovery {

/// Each is the function of <avahi-...> with the prefix "avahi_".
struct Avahi {
    decltype(&::avahi_client_new) client_new;
    decltype(&::avahi_client_free) client_free;
    decltype(&::avahi_client_errno) client_errno;
    decltype(&::avahi_client_get_host_name) client_get_host_name;
    decltype(&::avahi_client_get_local_service_cookie) client_get_local_service_cookie;
    decltype(&::avahi_entry_group_new) entry_group_new;
    decltype(&::avahi_entry_group_add_service_strlst) entry_group_add_service_strlst;
    decltype(&::avahi_entry_group_update_service_txt_strlst) entry_group_update_service_txt_strlst;
    decltype(&::avahi_entry_group_commit) entry_group_commit;
    decltype(&::avahi_entry_group_reset) entry_group_reset;
    decltype(&::avahi_service_browser_new) service_browser_new;
    decltype(&::avahi_service_resolver_new) service_resolver_new;
    decltype(&::avahi_service_resolver_free) service_resolver_free;
    decltype(&::avahi_simple_poll_new) simple_poll_new;
    decltype(&::avahi_simple_poll_get) simple_poll_get;
    decltype(&::avahi_simple_poll_iterate) simple_poll_iterate;
    decltype(&::avahi_simple_poll_wakeup) simple_poll_wakeup;
    decltype(&::avahi_simple_poll_free) simple_poll_free;
    decltype(&::avahi_string_list_new_from_array) string_list_new_from_array;
    decltype(&::avahi_string_list_free) string_list_free;
    decltype(&::avahi_address_snprint) address_snprint;
    decltype(&::avahi_alternative_service_name) alternative_service_name;
    decltype(&::avahi_free) free;
    decltype(&::avahi_strerror) strerror;
};

/// Null if this machine does not have them. Any thread; the first call loads them, and they are never unloaded.
const Avahi* avahi();
/// Is there a system bus, through which the daemon is reached? Costs one file system check.
bool has_system_bus();

}  // namespace hive::discovery
