#include "log_line.hpp"

#include <spdlog/spdlog.h>

namespace hive::service {
namespace {

spdlog::level::level_enum of_spdlog(LogLevel level)
{
    switch (level) {
    case LogLevel::debug: return spdlog::level::debug;
    case LogLevel::info: return spdlog::level::info;
    case LogLevel::warning: return spdlog::level::warn;
    case LogLevel::error: break;
    }
    return spdlog::level::err;
}

}  // namespace

void write_log_line(LogLevel level, const std::string& drone, const std::string& text)
{
    spdlog::log(of_spdlog(level), "{}: {}", drone, text);
}

}  // namespace hive::service
