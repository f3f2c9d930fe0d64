// Checks the token of a request. A browser has it from the address that the owner opens, and then in a cookie; a
// program sends it in a header.
#pragma once

#include <string>
#include <string_view>

namespace hive::http {

struct Request;

/// What a server of one port asks of its clients. Other users of the machine reach the port as well, and so does every
/// page that one of its browsers shows.
class Pass {
public:
    /// @param token        empty: no request is allowed
    /// @param cookie_name  cookies do not know ports, so it says which
    Pass(std::string token, std::string cookie_name);
    /// 128 bits of chance, as text.
    static std::string draw_token();

    /// Does another page ask, as far as the browser says?
    [[nodiscard]] static bool cross_site(const Request& request);
    [[nodiscard]] bool in_address(const Request& request) const;
    [[nodiscard]] bool in_cookie(const Request& request) const;
    /// "Authorization: Bearer TOKEN"
    [[nodiscard]] bool in_header(const Request& request) const;
    [[nodiscard]] const std::string& cookie_name() const noexcept { return name_; }
    /// What Set-Cookie says: for this host alone, not for scripts, and not with requests that other pages make.
    [[nodiscard]] std::string cookie() const;

private:
    [[nodiscard]] bool is_token(std::string_view text) const;
    std::string token_, name_;
};

}  // namespace hive::http
