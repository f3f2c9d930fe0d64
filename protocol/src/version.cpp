// The version of the build, and that of the protocol.
#include <hive/version.hpp>

#include <hive/protocol/packet.hpp>

namespace hive {

const char* version() noexcept { return HIVE_VERSION; }
int protocol_version() noexcept { return protocol::version; }

}  // namespace hive
