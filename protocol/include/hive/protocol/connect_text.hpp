// A connection as one word of a command line: "image=camera.image,at=tcp://cam1:7700,window=4".
#pragma once

#include <hive/protocol/requests.hpp>

#include <string>

namespace hive::protocol {

/// Reads [INPUT=]DRONE.OUTPUT[,OPTION...]; the input is empty where it is left out. The options are at=ADDRESS, stream,
/// notify, window=N, first_frame, share, group=NAME, lease=SECONDS and encoding=NAME. Throws Errc::invalid_argument.
Connect connect_from_text(const std::string& text);
/// What connect_from_text reads as this.
std::string to_text(const Connect& connect);

}  // namespace hive::protocol
