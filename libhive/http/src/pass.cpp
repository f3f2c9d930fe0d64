// Compares the credentials of a request with the token.
#include <hive/http/answer.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <sys/random.h>
#include <utility>

namespace hive::http {

Pass::Pass(std::string token, std::string cookie_name) : token_(std::move(token)), name_(std::move(cookie_name)) {}

std::string Pass::draw_token()
{
    std::array<unsigned char, 16> chance{};
    if (::getrandom(chance.data(), chance.size(), 0) != static_cast<ssize_t>(chance.size()))
        throw std::runtime_error("the system has no random numbers");
    std::string token;
    for (const unsigned byte : chance)
        for (const unsigned digit : {byte >> 4, byte & 15})
            token += "0123456789abcdef"[digit];
    return token;
}

bool Pass::cross_site(const Request& request)
{
    return !request.site.empty() && request.site != "same-origin" && request.site != "none";
}

bool Pass::in_address(const Request& request) const { return is_token(request.token); }
bool Pass::in_cookie(const Request& request) const { return is_token(request.cookie); }

bool Pass::in_header(const Request& request) const
{
    constexpr std::string_view scheme = "bearer ";
    const auto said = request.authorization.substr(0, scheme.size());
    return std::ranges::equal(said, scheme, {}, [](unsigned char c) { return std::tolower(c); })
           && is_token(request.authorization.substr(scheme.size()));
}

std::string Pass::cookie() const { return name_ + "=" + token_ + "; Path=/; HttpOnly; SameSite=Strict"; }

/// Takes the same time for every text of the right length.
bool Pass::is_token(std::string_view text) const
{
    if (token_.empty() || text.size() != token_.size())
        return false;
    unsigned char difference = 0;
    for (std::size_t i = 0; i < text.size(); ++i)
        difference |= static_cast<unsigned char>(text[i] ^ token_[i]);
    return difference == 0;
}

}  // namespace hive::http
