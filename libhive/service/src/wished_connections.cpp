// Checks connections as far as possible before the senders are up.
#include "wished_connections.hpp"

#include <hive/error.hpp>
#include <hive/transport/address.hpp>

#include <algorithm>

namespace hive::service {

using protocol::Connect;
using protocol::Expect;

namespace {

/// An address that a receiver can dial, or none.
void require_dialable(const std::string& text)
{
    if (text.empty())
        return;
    const auto address = transport::parse_address(text);
    if (address.scheme == transport::Address::Scheme::tcp && (address.is_everywhere() || address.port == 0))
        throw Error(Errc::invalid_argument, "cannot dial " + text,
                    "write at=tcp://HOST:PORT, the sender's address as seen from this machine");
}

/// The only port. @param what  "input"
std::string only_port(const std::string& self, const std::vector<Port>& ports, const std::string& what,
                      const char* advice)
{
    if (ports.size() == 1)
        return ports.front().name;
    if (ports.empty())
        throw Error(Errc::not_found, self + " has no " + what);
    std::string names;
    for (const auto& port : ports)
        names += (names.empty() ? "" : ", ") + port.name;
    throw Error(Errc::invalid_argument, self + " has several " + what + "s: " + names, advice);
}

void settle(Connect& connect, const Interface& interface, const std::string& self)
{
    if (connect.input.empty())
        connect.input = only_port(self, interface.inputs, "input", "say which: INPUT=DRONE.OUTPUT");
    port_named(interface.inputs, self, "input", connect.input);
    if (connect.drone == self && connect.address.empty())
        throw Error(Errc::invalid_argument, self + " cannot receive its own output");
    if (interface.stateful && !connect.options.group.empty())
        throw Error(Errc::refused, self + " keeps state between events, so it must see every one: it cannot share");
}

/// The same error with the connection in its text.
[[noreturn]] void rethrow(const Error& error, const Connect& connect)
{
    throw error.reworded("--connect " + to_text(connect) + ": " + error.what());
}

}  // namespace

std::vector<Connect> parse_connects(const std::vector<std::string>& words)
{
    std::vector<Connect> connections;
    for (const auto& word : words)
        try {
            connections.push_back(protocol::connect_from_text(word));
            require_dialable(connections.back().address);
        } catch (const Error& error) {
            throw error.reworded("--connect " + word + ": " + error.what());
        }
    return connections;
}

std::vector<Expect> expected_from(const std::vector<std::string>& words)
{
    std::vector<Expect> expected;
    for (const auto& word : words)
        try {
            expected.push_back(protocol::expect_from_text(word));
        } catch (const Error& error) {
            throw error.reworded("--expect " + word + ": " + error.what());
        }
    return expected;
}

void settle(std::vector<Expect>& expected, const Interface& interface, const std::string& self)
{
    for (auto& expect : expected)
        try {
            if (expect.output.empty())
                expect.output = only_port(self, interface.outputs, "output", "say which: OUTPUT=DRONE.INPUT");
            if (expect.output != "exceptions")
                port_named(interface.outputs, self, "output", expect.output);
        } catch (const Error& error) {
            throw error.reworded("--expect " + to_text(expect) + ": " + error.what());
        }
}

void settle(std::vector<Connect>& connections, const Interface& interface, const std::string& self)
{
    for (auto connect = connections.begin(); connect != connections.end(); ++connect)
        try {
            settle(*connect, interface, self);
            const auto same_ends = [&](const Connect& other) {
                return other.drone == connect->drone && other.output == connect->output
                       && other.input == connect->input;
            };
            if (std::any_of(connections.begin(), connect, same_ends))
                throw Error(Errc::invalid_argument, "it is given twice");
        } catch (const Error& error) {
            rethrow(error, *connect);
        }
}

}  // namespace hive::service
