// Compares addresses as 4 or 16 bytes, so that each address has one form.
#include "address_rule.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace axis {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view mapped_prefix = "\0\0\0\0\0\0\0\0\0\0\xFF\xFF"sv;

/// An IPv4-mapped IPv6 address becomes the IPv4 one.
std::string plain(std::string bytes)
{
    return bytes.starts_with(mapped_prefix) ? bytes.substr(mapped_prefix.size()) : bytes;
}

std::string bytes_of(const sockaddr& address)
{
    if (address.sa_family == AF_INET) {
        const auto& internet = reinterpret_cast<const sockaddr_in&>(address);
        return {reinterpret_cast<const char*>(&internet.sin_addr), sizeof internet.sin_addr};
    }
    if (address.sa_family == AF_INET6) {
        const auto& internet = reinterpret_cast<const sockaddr_in6&>(address);
        return plain({reinterpret_cast<const char*>(&internet.sin6_addr), sizeof internet.sin6_addr});
    }
    return {};
}

std::string parsed(const std::string& text)
{
    std::string bytes(sizeof(in6_addr), '\0');
    if (::inet_pton(AF_INET, text.c_str(), bytes.data()) == 1)
        return bytes.substr(0, sizeof(in_addr));
    if (::inet_pton(AF_INET6, text.c_str(), bytes.data()) == 1)
        return plain(bytes);
    throw std::invalid_argument("allow_address: bad address " + text);
}

bool special(const std::string& bytes)
{
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
    if (bytes.size() == 4)  // 0/8, 127/8, 169.254/16, 224/4 and above
        return at(0) == 0 || at(0) == 127 || (at(0) == 169 && at(1) == 254) || at(0) >= 224;
    if (bytes.size() != 16)
        return true;
    const bool zeros =
        std::all_of(bytes.begin(), bytes.begin() + 12, [](char c) { return c == 0; });  // ::, ::1, ::a.b.c.d
    return zeros || at(0) == 0xFF || (at(0) == 0xFE && (at(1) & 0xC0) == 0x80);
}

}  // namespace

AddressRule::AddressRule(const std::string& named)
{
    std::istringstream list(named);
    for (std::string one; std::getline(list, one, ',');)
        named_.push_back(parsed(one));
}

bool AddressRule::allows(const sockaddr& address) const
{
    const std::string bytes = bytes_of(address);
    return !special(bytes) || std::ranges::find(named_, bytes) != named_.end();
}

std::string address_text(const sockaddr& address)
{
    const std::string bytes = bytes_of(address);
    char text[INET6_ADDRSTRLEN] = "?";
    if (!bytes.empty())
        ::inet_ntop(bytes.size() == 4 ? AF_INET : AF_INET6, bytes.data(), text, sizeof text);
    return text;
}

}  // namespace axis
