// Checks the host, then who asks, then the method and the path. Who may not look learns nothing.
#include "answer.hpp"

#include "page.hpp"
#include "status.hpp"
#include "stream.hpp"

namespace view {
namespace {

Answer sentence(unsigned code, std::string text) { return {code, "text/plain; charset=utf-8", std::move(text) + "\n"}; }

}  // namespace

Answer not_ready() { return sentence(503, "The picture is not ready yet; ask again."); }

Answer answer_to(const Request& request, const Exchange& exchange, const Address& bind, const Pass& pass,
                 Browsers browsers)
{
    if (!request.host || !host_fits(*request.host, bind))
        return sentence(request.host ? 403 : 400, "Open this page by its address.");
    if (Pass::cross_site(request))
        return sentence(403, "Other pages may not look.");
    if (!pass.in_address(request) && !pass.in_cookie(request))
        return sentence(403, "Open the address that hivectl view prints, or that is in the log of the drone.");
    if (request.method != "GET")
        return sentence(405, "Only GET.");
    if (request.path == "/" && pass.in_address(request))
        return {.code = 303, .type = "text/plain; charset=utf-8", .body = "\n", .cookie = pass.cookie()};
    if (request.path == "/")
        return {200, "text/html; charset=utf-8", std::string(page_html)};
    if (request.path == "/view.css")
        return {200, "text/css; charset=utf-8", std::string(page_css)};
    if (request.path == "/view.js")
        return {200, "text/javascript; charset=utf-8", std::string(page_js)};
    if (request.path == "/status.json")
        return {200, "application/json", status_of(exchange.newest(), browsers.now).dump()};
    const bool plain = request.path.starts_with("/plain/");  // what the page shows: it says itself what a caption would
    if (request.path == "/picture.jpg" || request.path == "/plain/picture.jpg")
        return exchange.newest().number > 0 ? Answer{200, "image/jpeg", {}, Answer::picture, plain}
                                            : sentence(503, "There is no picture yet.");
    if (request.path == "/stream.mjpg" || request.path == "/plain/stream.mjpg")
        return browsers.now < browsers.most ? Answer{200, Stream::type, {}, Answer::stream, plain}
                                            : sentence(503, "Too many are looking.");
    return sentence(404, "There is nothing here.");
}

}  // namespace view
