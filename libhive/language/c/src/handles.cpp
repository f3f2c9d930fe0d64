// The table of handles, in shards, so that threads rarely wait for each other.
#include "handles.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <unordered_map>

namespace hive::c {
namespace {

struct Entry {
    std::shared_ptr<Object> object;
    std::size_t references = 1;
};

struct Part {
    std::mutex mutex;
    std::unordered_map<std::uintptr_t, Entry> entries;
};

constexpr std::size_t parts = 16;
std::atomic<std::uintptr_t> last_handle = 0;

/// Never destroyed: handles may be released while the process exits.
Part& part_of(std::uintptr_t handle)
{
    static auto* all = new std::array<Part, parts>;
    return (*all)[handle / 16 % parts];
}

std::uintptr_t number(const void* handle) { return reinterpret_cast<std::uintptr_t>(handle); }

}  // namespace

const void* add_handle(std::shared_ptr<Object> object)
{
    const std::uintptr_t handle = last_handle += 16;
    Part& part = part_of(handle);
    const std::lock_guard lock(part.mutex);
    part.entries.emplace(handle, Entry{.object = std::move(object)});
    return reinterpret_cast<const void*>(handle);  // NOLINT: never dereferenced
}

std::shared_ptr<Object> object_of(const void* handle)
{
    Part& part = part_of(number(handle));
    const std::lock_guard lock(part.mutex);
    const auto found = part.entries.find(number(handle));
    return found == part.entries.end() ? nullptr : found->second.object;
}

void refuse_handle(const void* handle, const char* kind)
{
    const std::string what = !handle             ? "null"
                             : object_of(handle) ? "a handle of another kind"
                                                 : "no handle, or one that was released";
    throw Error(Errc::invalid_argument, "this is no " + std::string(kind) + ": it is " + what);
}

namespace {

void retain(const void* handle)
{
    Part& part = part_of(number(handle));
    const std::lock_guard lock(part.mutex);
    const auto found = part.entries.find(number(handle));
    if (found == part.entries.end())
        throw Error(Errc::invalid_argument, "invalid or released handle");
    ++found->second.references;
}

void release(const void* handle)
{
    std::shared_ptr<Object> last;
    {
        Part& part = part_of(number(handle));
        const std::lock_guard lock(part.mutex);
        const auto found = part.entries.find(number(handle));
        if (found == part.entries.end())
            throw Error(Errc::invalid_argument, "invalid or released handle");
        if (--found->second.references > 0)
            return;
        last = std::move(found->second.object);
        part.entries.erase(found);
    }
    last->released();
}

std::size_t living()
{
    std::size_t count = 0;
    for (std::size_t i = 0; i < parts; ++i) {
        Part& part = part_of(16 * i);
        const std::lock_guard lock(part.mutex);
        count += part.entries.size();
    }
    return count;
}

}  // namespace
}  // namespace hive::c

using namespace hive::c;

hive_code hive_retain(const void* handle)
{
    return guarded([&] { retain(required(handle, "the handle")); });
}

hive_code hive_release(const void* handle)
{
    return guarded([&] {
        if (handle)
            release(handle);
    });
}

size_t hive_handle_count(void) { return living(); }
