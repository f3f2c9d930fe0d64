// Checks the host, then who asks, then the method.
#include <hive/http/answer.hpp>

namespace hive::http {

Answer sentence(unsigned code, std::string text)
{
    return {.code = code, .type = "text/plain; charset=utf-8", .body = std::move(text) + "\n"};
}

std::optional<Answer> refusal(const Request& request, const Address& bind, const Pass& pass, const char* hint)
{
    if (!request.host || !host_fits(*request.host, bind))
        return sentence(request.host ? 403 : 400, "Open this page by its address.");
    if (Pass::cross_site(request))
        return sentence(403, "Other pages may not look.");
    if (!pass.in_address(request) && !pass.in_cookie(request))
        return sentence(403, hint);
    if (request.method != "GET")
        return sentence(405, "Only GET.");
    return std::nullopt;
}

}  // namespace hive::http
