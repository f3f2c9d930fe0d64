// What a module holds for receivers that are still to come.
#include "fixtures.hpp"

#include <hive/event/module.hpp>

#include <doctest/doctest.h>

namespace hive::event {
namespace {

using protocol::PacketType;

/// A module without network side: its own thread is never started.
struct Alone {
    Module module{{.self = {.name = "worker", .kind = "sleeper", .epoch = 1, .pid = 1}, .limits = {}, .timing = {}}};
};

}  // namespace

TEST_CASE("module: a lossless result without any receiver holds up the intakes until one comes")
{
    Alone alone;
    Outlet& results = alone.module.add_outlet({"result", "application/json", ""});
    alone.module.emit(results, emission(1, true));
    CHECK(alone.module.paused() == Reason::backlog);
}

TEST_CASE("module: an exception that a lossless event has caused holds up nothing, whether there are results or not")
{
    Alone alone;
    Outlet& exceptions =
        alone.module.add_outlet({"exceptions", "application/x-hive-exception", ""}, PacketType::exception);
    alone.module.emit(exceptions, emission(1, true));
    CHECK(alone.module.paused() == Reason::none);
    alone.module.add_outlet({"result", "application/json", ""});
    alone.module.emit(exceptions, emission(2, true));
    CHECK(alone.module.paused() == Reason::none);
}

}  // namespace hive::event
