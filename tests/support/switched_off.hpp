// The twin of a test: the same without a defence, which must fail, or the test proves nothing.
#pragma once

#include <hive/protocol/defended.hpp>

#include <cstdlib>

namespace hive::test {

/// Disables a defence in the test itself and in every program started meanwhile (hive/protocol/defended.hpp).
class SwitchedOff {
public:
    explicit SwitchedOff(const char* defence)
    {
        ::setenv("HIVE_TEST_WITHOUT", defence, 1);
        hive::leave_out(defence);
    }
    ~SwitchedOff()
    {
        ::unsetenv("HIVE_TEST_WITHOUT");
        hive::leave_out({});
    }
    SwitchedOff(const SwitchedOff&) = delete;
    SwitchedOff& operator=(const SwitchedOff&) = delete;
};

}  // namespace hive::test
