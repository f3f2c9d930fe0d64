// Turns status codes and error codes of libcurl into sentences.
#include "http_error.hpp"

#include <curl/curl.h>

#include <algorithm>
#include <cctype>
#include <cerrno>

namespace axis {
namespace {

bool offers_digest(const Head& head)
{
    constexpr std::string_view scheme = "digest";
    return std::ranges::any_of(head.challenges, [&](const std::string& challenge) {
        return std::ranges::equal(challenge.substr(0, scheme.size()), scheme, {},
                                  [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    });
}

CameraError error_of_login(const Access& access, const Head& head)
{
    if (!access.credentials)
        return {Failure::login_needed, "login required; set credentials"};
    if (!offers_digest(head) && !access.url.encrypted() && !access.basic_over_http)
        return {Failure::login_needed,
                "the camera offers only basic authentication over http; use https, or set basic_over_http=on"};
    return {Failure::login_refused, "the camera refuses the password of " + masked(access.credentials->user)};
}

}  // namespace

CameraError error_of_status(const Access& access, const Head& head)
{
    const std::string host = access.url.text(), status = std::to_string(head.status);
    if (head.status == 401)
        return error_of_login(access, head);
    if (head.status >= 300 && head.status < 400)
        return {Failure::redirected,
                host + " points to " + masked(head.location) + " (" + status + "), which is not followed"};
    if (head.status == 404)
        return {Failure::not_vapix, "not a VAPIX device: " + host + " lacks what every Axis camera has (404)"};
    return {Failure::refused_status, host + " answers with status " + status};
}

CameraError error_of_transfer(const Access& access, const Limits& limits, int code, long problem)
{
    const std::string host = access.url.text(), reason = curl_easy_strerror(static_cast<CURLcode>(code));
    switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST: return {Failure::unknown_host, "no such host: " + access.url.host};
    case CURLE_COULDNT_CONNECT:
        return problem == ECONNREFUSED ? CameraError(Failure::refused, "connection refused by " + host)
                                       : CameraError(Failure::no_route, "no route to " + host);
    case CURLE_OPERATION_TIMEDOUT:
        return {Failure::no_answer,
                "no connection to " + host + " within " + std::to_string(limits.connecting.count() / 1000) + " s"};
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_PEER_FAILED_VERIFICATION:
        return {Failure::insecure, "no encrypted connection to " + host + ": " + reason};
    case CURLE_SSL_CACERT_BADFILE:
        return {Failure::insecure, "no encrypted connection to " + host + ": the certificate in "
                                       + (access.certificate.empty() ? "the system" : access.certificate)
                                       + " cannot be read"};
    case CURLE_UNSUPPORTED_PROTOCOL:
    case CURLE_WEIRD_SERVER_REPLY: return {Failure::not_vapix, "not a VAPIX device: " + host + " does not use HTTP"};
    case CURLE_OUT_OF_MEMORY: return {Failure::too_large, "the head of the answer is too large"};  // one endless line
    default: return {Failure::closed, host + " closed the connection: " + reason};
    }
}

}  // namespace axis
