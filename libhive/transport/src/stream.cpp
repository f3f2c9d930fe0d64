// The default for streams without descriptors.
#include "os_text.hpp"

#include <hive/transport/stream.hpp>

#include <system_error>

namespace hive::transport {

void Stream::write_with(int, std::span<const asio::const_buffer>, Handler)
{
    throw Error(Errc::unsupported, "this transport passes no descriptors");
}

std::string os_text(int error) { return std::generic_category().message(error); }

}  // namespace hive::transport
