// Uses inet_pton, with rules for special addresses.
#include <hive/http/host.hpp>

#include <algorithm>
#include <arpa/inet.h>
#include <cctype>
#include <cstring>
#include <netinet/in.h>
#include <optional>
#include <stdexcept>

namespace hive::http {
namespace {

const in_addr& v4(const sockaddr* address) { return reinterpret_cast<const sockaddr_in*>(address)->sin_addr; }
const in6_addr& v6(const sockaddr* address) { return reinterpret_cast<const sockaddr_in6*>(address)->sin6_addr; }

bool equal_ignoring_case(std::string_view a, std::string_view b)
{
    return std::ranges::equal(a, b,
                              [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// The host in "host", "host:80", "[host]", "[host]:80"; nothing in any other form.
std::optional<std::string> without_port(std::string_view text)
{
    const bool bracketed = text.starts_with('[');
    const auto end = text.find(bracketed ? ']' : ':');
    if (bracketed && end == text.npos)
        return std::nullopt;
    const auto host = text.substr(bracketed ? 1 : 0, end - (bracketed ? 1 : 0));
    auto rest = end == text.npos ? std::string_view() : text.substr(end + (bracketed ? 1 : 0));
    const bool digits = std::ranges::all_of(rest.substr(std::min<std::size_t>(1, rest.size())),
                                            [](char c) { return c >= '0' && c <= '9'; });
    if (!rest.empty() && (rest.front() != ':' || rest.size() > 6 || !digits))
        return std::nullopt;
    return std::string(host);
}

}  // namespace

Address::Address(const std::string& text, int port)
{
    auto& four = reinterpret_cast<sockaddr_in&>(storage_);
    auto& six = reinterpret_cast<sockaddr_in6&>(storage_);
    if (::inet_pton(AF_INET, text.c_str(), &four.sin_addr) == 1) {
        four.sin_family = AF_INET;
        four.sin_port = htons(static_cast<std::uint16_t>(port));
        return;
    }
    storage_ = {};
    if (::inet_pton(AF_INET6, text.c_str(), &six.sin6_addr) != 1)
        throw std::runtime_error(
            "\"" + text
            + "\" is not an address; write for example 127.0.0.1, or 0.0.0.0 for every address of this machine");
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(static_cast<std::uint16_t>(port));
}

socklen_t Address::size() const noexcept
{
    return storage_.ss_family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
}

bool Address::any() const noexcept
{
    return storage_.ss_family == AF_INET ? v4(raw()).s_addr == htonl(INADDR_ANY) : IN6_IS_ADDR_UNSPECIFIED(&v6(raw()));
}

bool Address::loopback() const noexcept
{
    return storage_.ss_family == AF_INET ? (ntohl(v4(raw()).s_addr) >> 24) == 127 : IN6_IS_ADDR_LOOPBACK(&v6(raw()));
}

bool Address::same_host(const Address& other) const noexcept
{
    if (storage_.ss_family != other.storage_.ss_family)
        return false;
    return storage_.ss_family == AF_INET ? v4(raw()).s_addr == v4(other.raw()).s_addr
                                         : std::memcmp(&v6(raw()), &v6(other.raw()), sizeof(in6_addr)) == 0;
}

bool host_fits(std::string_view text, const Address& bind)
{
    const auto host = without_port(text);
    if (!host)
        return false;
    if (equal_ignoring_case(*host, "localhost"))
        return true;
    try {
        const Address address(*host, 0);
        return bind.any() || address.loopback() || address.same_host(bind);
    } catch (const std::runtime_error&) {  // a name
        return false;
    }
}

std::string url_of(const std::string& bind, int port)
{
    const bool six = bind.find(':') != bind.npos;
    return "http://" + (six ? "[" + bind + "]" : bind) + ":" + std::to_string(port) + "/";
}

}  // namespace hive::http
