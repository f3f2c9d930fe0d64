// The drones of the benchmark: a source of frames, a sink, and one that has a parameter. Each is a real drone, run by
// run_drone, in a process of its own.
#pragma once

#include "../harness/transport.hpp"

namespace hive::bench {

constexpr auto source_name = "source", frame_port = "frame", note_parameter = "note";
/// The value of the parameter that is asked for: 64 bytes.
constexpr auto note_text = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

std::string sink_name(int index);
/// Does this variant go over TCP, in the plain or under a key?
bool over_tcp(const Run& run);
/// Where the source listens beside its local socket, in the variants that go over TCP.
std::string tcp_address(const Run& run);

std::unique_ptr<Publisher> make_source(const Run& run);
std::unique_ptr<Subscriber> make_sink(const Run& run);
std::unique_ptr<Server> make_answering_drone(const Run& run);

}  // namespace hive::bench
