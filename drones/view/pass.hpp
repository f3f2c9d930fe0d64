// Who may look: whoever knows the token, which is in the address that the owner opens, and then in a cookie.
#pragma once

#include <string>
#include <string_view>

namespace view {

struct Request;

/// What a server of one port asks of its browsers. Other users of the machine reach the port as well, and so does every
/// page that one of its browsers shows.
class Pass {
public:
    /// @param token  empty: nobody may look
    Pass(std::string token, int port);
    /// 128 bits of chance, as text.
    static std::string draw_token();

    /// Does another page ask, as far as the browser says?
    [[nodiscard]] static bool cross_site(const Request& request);
    [[nodiscard]] bool in_address(const Request& request) const;
    [[nodiscard]] bool in_cookie(const Request& request) const;
    /// Cookies do not know ports, so the name says which.
    [[nodiscard]] const std::string& cookie_name() const noexcept { return name_; }
    /// What Set-Cookie says: for this host alone, not for scripts, and not with requests that other pages make.
    [[nodiscard]] std::string cookie() const;

private:
    [[nodiscard]] bool is_token(std::string_view text) const;
    std::string token_, name_;
};

}  // namespace view
