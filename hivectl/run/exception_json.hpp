// The last exception of a drone, as --json prints it.
#pragma once

#include <hive/status.hpp>

namespace hivectl {

inline hive::Json exception_json(const hive::ExceptionStatus& exception)
{
    return {{"code", exception.code},      {"input", exception.input},   {"policy", exception.policy},
            {"seq", exception.sequence},   {"source", exception.source}, {"text", exception.text},
            {"time_us", exception.time_us}};
}

}  // namespace hivectl
