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

/// The used functions of <avahi-...>, without their prefix "avahi_".
// clang-format off
#define HIVE_AVAHI_FUNCTIONS(use) \
    use(client_new) use(client_free) use(client_errno) use(client_get_host_name) \
    use(client_get_local_service_cookie) use(entry_group_new) use(entry_group_add_service_strlst) \
    use(entry_group_update_service_txt_strlst) use(entry_group_commit) use(entry_group_reset) \
    use(service_browser_new) use(service_resolver_new) use(service_resolver_free) use(simple_poll_new) \
    use(simple_poll_get) use(simple_poll_iterate) use(simple_poll_wakeup) use(simple_poll_free) \
    use(string_list_new_from_array) use(string_list_free) use(address_snprint) use(alternative_service_name) \
    use(free) use(strerror)
// clang-format on

struct Avahi {
#define HIVE_DECLARE(name) decltype(&::avahi_##name) name;
    HIVE_AVAHI_FUNCTIONS(HIVE_DECLARE)
#undef HIVE_DECLARE
};

/// Null if this machine does not have them. Any thread; the first call loads them, and they are never unloaded.
const Avahi* avahi();
/// Is there a system bus, through which the daemon is reached? Costs one file system check.
bool has_system_bus();

}  // namespace hive::discovery
