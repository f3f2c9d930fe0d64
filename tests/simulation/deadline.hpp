// Checks the duration of an application's calls.
#pragma once

#include "world.hpp"

#include <utility>

namespace hive::simulation {

/// deadline: no call takes longer than the application's timeout, plus a margin for its own work.
class Deadline {
public:
    static constexpr auto margin = std::chrono::milliseconds(250);

    explicit Deadline(std::chrono::milliseconds timeout) : limit_(timeout + margin) {}

    /// Also of a call that throws.
    template <class Call>
    auto keep(const std::string& what, const Call& call)
    {
        const Stopwatch stopwatch{*this, what, world().now()};
        return call();
    }
    void took(const std::string& what, Duration time)
    {
        if (time > limit_)
            problems_.push_back("deadline: " + what + " took "
                                + std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count())
                                + " ms");
    }
    std::vector<std::string> take_problems() { return std::exchange(problems_, {}); }

private:
    struct Stopwatch {
        Deadline& deadline;
        const std::string& what;
        const Time begin;
        ~Stopwatch() { deadline.took(what, world().now() - begin); }
    };
    const Duration limit_;
    std::vector<std::string> problems_;
};

}  // namespace hive::simulation
