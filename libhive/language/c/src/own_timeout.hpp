// A call with a deadline of its own.
#pragma once

#include <hive/application.hpp>

#include <chrono>

namespace hive::c {

/// Another timeout for as long as this lives, also where a call is cancelled.
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
