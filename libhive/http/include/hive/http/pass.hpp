// Checks the token of a request. A browser gets the token from the address that the owner opens, and then keeps it in a
// cookie; a program sends it in a header.
#pragma once

#include <string>
#include <string_view>

namespace hive::http {

struct Request;

/// The credentials that a server at one port requires. Other users of the machine reach the port too, and so does every
/// page that a browser on it shows.
class Pass {
public:
    /// @param token        empty: no request is allowed
    /// @param cookie_name  has the port in it, because browsers send cookies to all ports of a host
    Pass(std::string token, std::string cookie_name);
    /// 128 random bits, as text.
    static std::string draw_token();

    /// Does the browser report that another page sends the request?
    [[nodiscard]] static bool cross_site(const Request& request);
    [[nodiscard]] bool in_address(const Request& request) const;
    [[nodiscard]] bool in_cookie(const Request& request) const;
    /// "Authorization: Bearer TOKEN"
    [[nodiscard]] bool in_header(const Request& request) const;
    [[nodiscard]] const std::string& cookie_name() const noexcept { return name_; }
    /// The value of Set-Cookie: for this host alone, hidden from scripts, and not sent with requests of other pages.
    [[nodiscard]] std::string cookie() const;

private:
    [[nodiscard]] bool is_token(std::string_view text) const;
    std::string token_, name_;
};

}  // namespace hive::http
