// The cancellation callback of a thread, polled while its calls wait.
#pragma once

namespace hive::c {

/// Has the caller cancelled, on this thread?
bool wait_is_cancelled();
/// Throws Errc::stopped if so.
void require_wait();

/// While one lives on this thread, the caller is still polled, but only this object has the answer: calls continue, so
/// that changes can be rolled back.
class Undoable {
public:
    Undoable() noexcept;
    ~Undoable();
    Undoable(const Undoable&) = delete;
    Undoable& operator=(const Undoable&) = delete;

    /// Polls; a cancellation is final.
    [[nodiscard]] bool is_cancelled();

private:
    Undoable* outer_;
    bool cancelled_ = false;
};

}  // namespace hive::c
