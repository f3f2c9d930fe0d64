// What this machine knows of a drone that runs or has crashed: its kind and its parameters.
#pragma once

#include <hive/application.hpp>

namespace hive {

struct KnownProgram {
    std::string kind{};  ///< or a Python file; empty: unknown
    Json parameters = Json::object();
};

KnownProgram known_program(Application& application, const std::string& drone);

}  // namespace hive
