// Runs a call with its own timeout.
#pragma once

#include <hive/application.hpp>

#include <chrono>

namespace hive::c {

/// Changes the timeout during its lifetime, and restores it even if the call throws.
class OwnTimeout {
public:
    OwnTimeout(Application& application, std::chrono::milliseconds own, std::chrono::milliseconds before)
        : application_(application), before_(before)
    {
        application_.timeout(own);
    }
    ~OwnTimeout() { application_.timeout(before_); }
    OwnTimeout(const OwnTimeout&) = delete;
    OwnTimeout& operator=(const OwnTimeout&) = delete;

private:
    Application& application_;
    std::chrono::milliseconds before_;
};

}  // namespace hive::c
