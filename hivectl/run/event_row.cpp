// The fields of an event.
#include "run/event_row.hpp"

namespace hivectl {

Row event_row(const hive::Event& event)
{
    const auto& identity = event.identity;
    return {{"source", identity.source},
            {"epoch", identity.epoch},
            {"seq", identity.sequence},
            {"sender", event.sender},
            {"output", event.output},
            {"time_us", identity.captured_us},
            {"age_ms", static_cast<double>(event.age().count()) / 1000},
            {"size", event.sized ? hive::Json(event.size) : hive::Json()},
            {"header", event.header}};
}

}  // namespace hivectl
