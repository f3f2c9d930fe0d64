// Addresses as text.
#include <hive/error.hpp>
#include <hive/transport/listen_address.hpp>

#include <algorithm>
#include <charconv>

namespace hive::transport {
namespace {

[[noreturn]] void fail(std::string_view text, const std::string& why, const std::string& advice)
{
    throw Error(Errc::invalid_argument, "invalid address \"" + std::string(text.substr(0, 200)) + "\": " + why, advice);
}

constexpr auto tcp_form = "use tcp://HOST:PORT";

std::uint16_t parse_port(std::string_view text, std::string_view digits)
{
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
    if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size())
        fail(text, "the port is not a number from 0 to 65535", tcp_form);
    return port;
}

bool is_host(std::string_view host)
{
    return !host.empty() && host.size() <= 255 && std::ranges::all_of(host, [](unsigned char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-'
               || c == '_' || c == ':' || c == '%';
    });
}

Address parse_tcp(std::string_view text, std::string_view rest)
{
    const auto colon = rest.rfind(':');
    if (colon == std::string_view::npos)
        fail(text, "the port is missing", tcp_form);
    auto host = rest.substr(0, colon);
    if (host.size() >= 2 && host.front() == '[' && host.back() == ']')
        host = host.substr(1, host.size() - 2);
    else if (host.find(':') != std::string_view::npos)
        fail(text, "an IPv6 address needs brackets", "use tcp://[::1]:PORT");
    if (!is_host(host))
        fail(text, "the host is missing or has characters that no host has", tcp_form);
    return {Address::Scheme::tcp, std::string(host), parse_port(text, rest.substr(colon + 1))};
}

/// A path: not empty, no byte that ends a C string.
Address parse_path(std::string_view text, std::string_view name)
{
    if (name.empty() || name.find('\0') != std::string_view::npos)
        fail(text, "no name follows the colon", "use unix:/PATH");
    return {Address::Scheme::unix_socket, std::string(name), 0};
}

}  // namespace

Address parse_address(std::string_view text)
{
    const auto after = [text](std::string_view scheme) { return text.substr(scheme.size()); };
    if (text.starts_with("unix:"))
        return parse_path(text, after("unix:"));
    if (text.starts_with("tcp://"))
        return parse_tcp(text, after("tcp://"));
    fail(text, "it does not start with tcp:// or unix:", tcp_form);
}

Address listen_address(const std::string& text)
{
    const auto colon = text.rfind(':'), bracket = text.rfind(']');
    const bool without_port =
        text.starts_with("tcp://") && (colon == 3 || (bracket != std::string::npos && colon < bracket));
    return parse_address(without_port ? text + ":0" : text);
}

std::string to_text(const Address& address)
{
    switch (address.scheme) {
    case Address::Scheme::unix_socket: return "unix:" + address.host;
    case Address::Scheme::tcp: break;
    }
    const bool number6 = address.host.find(':') != std::string::npos;
    return "tcp://" + (number6 ? "[" + address.host + "]" : address.host) + ":" + std::to_string(address.port);
}

}  // namespace hive::transport
