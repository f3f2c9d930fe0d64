// A connection as one command-line argument: of its receiver, "image=camera.image,at=tcp://cam1:7700,window=4", and of
// its sender, "image=face.image,group=faces".
#pragma once

#include <hive/protocol/requests.hpp>

#include <string>

namespace hive::protocol {

/// Reads [INPUT=]DRONE.OUTPUT[,OPTION...]; the input is empty if omitted. Throws Errc::invalid_argument.
Connect connect_from_text(const std::string& text);
/// The text that connect_from_text reads.
std::string to_text(const Connect& connect);

/// A receiver that a sender waits for.
struct Expect {
    std::string output, receiver;  ///< "image", "face.image"
    std::string group{};           ///< in which it shares the work; empty: none
};
/// Reads [OUTPUT=]DRONE.INPUT[,group=NAME]; the output is empty if omitted. Throws Errc::invalid_argument.
Expect expect_from_text(const std::string& text);
/// The text that expect_from_text reads.
std::string to_text(const Expect& expect);

}  // namespace hive::protocol
