// Accepts the URLs of cameras, and refuses any other with a reason.
#include "camera_url.hpp"

#include <charconv>
#include <stdexcept>
#include <string_view>

namespace axis {
namespace {

constexpr std::string_view host_characters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
constexpr std::string_view address_characters = "0123456789abcdefABCDEF:.";

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument("url: " + why); }

int parse_port(std::string_view text)
{
    int port = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (problem != std::errc() || end != text.data() + text.size() || port < 1 || port > 65535)
        refuse("the port is a number from 1 to 65535");
    return port;
}

void check_host(std::string_view host)
{
    const bool bracketed = host.size() > 2 && host.front() == '[' && host.back() == ']';
    const std::string_view inner = bracketed ? host.substr(1, host.size() - 2) : host;
    if (inner.empty()
        || inner.find_first_not_of(bracketed ? address_characters : host_characters) != std::string_view::npos)
        refuse("the host is missing");
}

}  // namespace

std::string CameraUrl::text() const { return scheme + "://" + host + (port > 0 ? ":" + std::to_string(port) : ""); }

CameraUrl parse_camera_url(const std::string& text)
{
    const std::size_t colon = text.find("://");
    CameraUrl url;
    url.scheme = colon == std::string::npos ? "" : text.substr(0, colon);
    if (url.scheme != "http" && url.scheme != "https")
        refuse("write http:// or https:// and the host of the camera");
    std::string_view rest = std::string_view(text).substr(colon + 3);
    if (rest.find('@') != std::string_view::npos)
        refuse(
            "user names and passwords are not allowed here, where anyone can read them: use the parameter credentials");
    if (rest.ends_with('/'))
        rest.remove_suffix(1);
    if (rest.find_first_of("/?#") != std::string_view::npos)
        refuse("give only the host, no path: the drone knows the paths of an Axis camera");
    const std::size_t end = rest.starts_with('[') ? rest.find(']') : 0;
    const std::size_t port = end == std::string_view::npos ? end : rest.find(':', end);
    if (port != std::string_view::npos)
        url.port = parse_port(rest.substr(port + 1));
    url.host = rest.substr(0, port);
    check_host(url.host);
    return url;
}

}  // namespace axis
