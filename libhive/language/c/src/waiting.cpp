// Polls the caller for cancellation.
#include "waiting.hpp"

#include "errors.hpp"

#include <utility>

namespace hive::c {
namespace {

struct Asked {
    hive_callback callback = nullptr;
    void* user = nullptr;
};
thread_local Asked asked;
thread_local Undoable* undoable = nullptr;

bool says_so()
{
    const Asked now = asked;
    return now.callback && now.callback(now.user) != HIVE_OK;
}

}  // namespace

bool wait_is_cancelled()
{
    if (!undoable)
        return says_so();
    static_cast<void>(undoable->is_cancelled());
    return false;
}

void require_wait()
{
    if (wait_is_cancelled())
        throw Error(Errc::stopped, "cancelled while it waited");
}

Undoable::Undoable() noexcept : outer_(std::exchange(undoable, this)) {}
Undoable::~Undoable() { undoable = outer_; }

/// Polls even if already cancelled: the caller may process signals meanwhile.
bool Undoable::is_cancelled() { return cancelled_ = says_so() || cancelled_; }

}  // namespace hive::c

hive_code hive_on_wait(hive_callback callback, void* user)
{
    hive::c::asked = {callback, user};
    return HIVE_OK;
}
