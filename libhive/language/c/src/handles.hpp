// The handles of the ABI: numbers of objects, never reused.
#pragma once

#include "errors.hpp"

#include <cstddef>
#include <memory>

namespace hive::c {

/// An object with a handle. For any thread, unless a function says otherwise.
class Object {
public:
    Object() = default;
    virtual ~Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    /// The last handle was released. Calls of other threads may be running; the object is destroyed after them.
    virtual void released() {}
};

/// Creates a handle of an object, with one reference.
const void* add_handle(std::shared_ptr<Object> object);
/// The object, or null.
std::shared_ptr<Object> object_of(const void* handle);

[[noreturn]] void refuse_handle(const void* handle, const char* kind);

/// The object of a handle of that kind. Throws Errc::invalid_argument.
template <class Kind>
std::shared_ptr<Kind> get(const typename Kind::Handle* handle)
{
    if (auto object = std::dynamic_pointer_cast<Kind>(object_of(handle)))
        return object;
    refuse_handle(handle, Kind::name);
}

template <class Kind>
typename Kind::Handle* give(std::shared_ptr<Kind> object)
{
    return static_cast<typename Kind::Handle*>(const_cast<void*>(add_handle(std::move(object))));
}

}  // namespace hive::c
