// What a thread has said that is to be asked while its calls wait.
#pragma once

namespace hive::c {

/// Does the caller, on this thread, no longer want to wait?
bool wait_is_cancelled();
/// Throws Errc::stopped if so.
void require_wait();

/// While one lives on this thread, the caller is asked as ever, but only this one knows the answer: calls go on, so
/// that what was begun can be undone.
class Undoable {
public:
    Undoable() noexcept;
    ~Undoable();
    Undoable(const Undoable&) = delete;
    Undoable& operator=(const Undoable&) = delete;

    /// Asks; whoever has said so once cannot take it back.
    [[nodiscard]] bool is_cancelled();

private:
    Undoable* outer_;
    bool cancelled_ = false;
};

}  // namespace hive::c
