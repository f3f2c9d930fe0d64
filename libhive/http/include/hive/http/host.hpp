// Parses the addresses to listen at, and checks the names that browsers may use for them.
#pragma once

#include <string>
#include <string_view>
#include <sys/socket.h>

namespace hive::http {

/// An IPv4 or IPv6 address and a port.
class Address {
public:
    /// Throws std::runtime_error when `text` is not an address: names are not looked up.
    Address(const std::string& text, int port);
    [[nodiscard]] const sockaddr* raw() const noexcept { return reinterpret_cast<const sockaddr*>(&storage_); }
    [[nodiscard]] socklen_t size() const noexcept;
    [[nodiscard]] bool any() const noexcept;  ///< 0.0.0.0 or ::
    [[nodiscard]] bool loopback() const noexcept;
    [[nodiscard]] bool same_host(const Address& other) const noexcept;

private:
    sockaddr_storage storage_{};
};

/// May a listener at `bind` answer a request with this Host header? A foreign page can let its own name resolve to our
/// address (DNS rebinding), but cannot make the browser send an address or "localhost" as the host, so other names are
/// refused.
bool host_fits(std::string_view host, const Address& bind);

/// "http://127.0.0.1:8080/", "http://[::1]:8080/"
std::string url_of(const std::string& bind, int port);

}  // namespace hive::http
