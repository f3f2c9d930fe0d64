// Checks the client, then the path.
#include "answer.hpp"

#include "page.hpp"
#include "status.hpp"
#include "stream.hpp"

namespace view {
namespace {

Answer sentence(unsigned code, std::string text) { return {hive::http::sentence(code, std::move(text))}; }
Answer page(const char* type, std::string body) { return {{.type = type, .body = std::move(body)}}; }

}  // namespace

Answer not_ready() { return sentence(503, "The image is not ready yet; ask again."); }

Answer answer_to(const Request& request, const Exchange& exchange, const Address& bind, const Pass& pass,
                 Browsers browsers)
{
    if (auto refused = hive::http::refusal(
            request, bind, pass, "Open the address that hivectl view prints, or that is in the log of the drone."))
        return {std::move(*refused)};
    if (request.path == "/" && pass.in_address(request))
        return {{.code = 303, .type = "text/plain; charset=utf-8", .body = "\n", .cookie = pass.cookie()}};
    if (request.path == "/")
        return page("text/html; charset=utf-8", std::string(page_html));
    if (request.path == "/view.css")
        return page("text/css; charset=utf-8", std::string(page_css));
    if (request.path == "/view.js")
        return page("text/javascript; charset=utf-8", std::string(page_js));
    if (request.path == "/status.json")
        return page("application/json", status_of(exchange.newest(), browsers.now).dump());
    const bool plain = request.path.starts_with("/plain/");  // for the page, which shows the caption's content itself
    if (request.path == "/picture.jpg" || request.path == "/plain/picture.jpg")
        return exchange.newest().number > 0 ? Answer{{.type = "image/jpeg"}, Answer::image, plain}
                                            : sentence(503, "There is no image yet.");
    if (request.path == "/stream.mjpg" || request.path == "/plain/stream.mjpg")
        return browsers.now < browsers.most ? Answer{{.type = Stream::type}, Answer::stream, plain}
                                            : sentence(503, "Too many viewers.");
    return sentence(404, "Not found.");
}

}  // namespace view
