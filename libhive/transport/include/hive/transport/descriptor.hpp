// Descriptors by the name that the layers above use.
#pragma once

#include <hive/platform/descriptor.hpp>

namespace hive::transport {

using platform::Descriptor;

}  // namespace hive::transport
