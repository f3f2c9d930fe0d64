// Checks the host, then the client, then the method.
#include <hive/http/answer.hpp>

namespace hive::http {

Answer sentence(unsigned code, std::string text)
{
    return {.code = code, .type = "text/plain; charset=utf-8", .body = std::move(text) + "\n"};
}

namespace {

std::optional<Answer> refusal_of_anyone(const Request& request, const Address& bind, const Pass& pass, const char* hint)
{
    if (!request.host || !host_fits(*request.host, bind))
        return sentence(request.host ? 403 : 400, "Open this page by its address.");
    if (Pass::cross_site(request))
        return sentence(403, "Cross-site access denied.");
    if (!pass.in_address(request) && !pass.in_cookie(request))
        return sentence(403, hint);
    return std::nullopt;
}

}  // namespace

std::optional<Answer> refusal(const Request& request, const Address& bind, const Pass& pass, const char* hint)
{
    if (auto refused = refusal_of_anyone(request, bind, pass, hint))
        return refused;
    if (request.method != "GET")
        return sentence(405, "Only GET.");
    return std::nullopt;
}

std::optional<Answer> refusal_of_command(const Request& request, const Address& bind, const Pass& pass,
                                         const char* hint)
{
    if (auto refused = refusal_of_anyone(request, bind, pass, hint))
        return refused;
    if (request.method == "GET")
        return std::nullopt;
    if (request.method != "POST")
        return sentence(405, "Only GET and POST.");
    if (!pass.in_cookie(request) || request.origin != "http://" + std::string(*request.host))
        return sentence(403, "Only the page itself may change anything.");
    if (!request.content_type.starts_with("application/json"))
        return sentence(415, "Send JSON.");
    return std::nullopt;
}

}  // namespace hive::http
