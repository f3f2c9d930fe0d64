// A simulated thread: a stack of its own, that is left and entered again.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace hive::simulation {

/// It must have ended before it is destroyed. For one real thread.
class Fiber {
public:
    /// @param main  must not throw
    explicit Fiber(std::function<void()> main);
    ~Fiber();
    Fiber(const Fiber&) = delete;
    Fiber& operator=(const Fiber&) = delete;

    /// Runs it until it leaves or has ended. Also from inside another one.
    void enter();
    /// From inside: returns to the caller of enter(), until it is entered again.
    void leave();
    [[nodiscard]] bool ended() const { return ended_; }

private:
    struct Context;
    static void begin();

    std::function<void()> main_;
    std::unique_ptr<Context> context_;
    bool ended_ = false;
};

}  // namespace hive::simulation
