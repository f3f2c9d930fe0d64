// The login of a network camera, and the limits that FFmpeg has options for.
#include "url_options.hpp"

#include <cctype>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace camera {
namespace {

constexpr const char* user_variable = "HIVE_CAMERA_USER";
constexpr const char* password_variable = "HIVE_CAMERA_PASSWORD";
constexpr const char* camera_formats =
    "asf,avi,flv,live_flv,gif,h264,hevc,ivf,obu,jpeg_pipe,png_pipe,webp_pipe,m4v,matroska,mjpeg,mov,mpeg,mpegts,"
    "mpegvideo,mpjpeg,nut,ogg,rtsp";

/// For the place of a URL where the login stands (RFC 3986, section 3.2.1).
std::string encoded(const std::string& text)
{
    constexpr std::string_view digits = "0123456789ABCDEF";
    std::string result;
    for (const unsigned char c : text)
        if (std::isalnum(c) || std::string_view("-._~").find(static_cast<char>(c)) != std::string_view::npos)
            result += static_cast<char>(c);
        else
            ((result += '%') += digits[c >> 4]) += digits[c & 15];
    return result;
}

/// "http://host:port" of a URL.
std::string camera_of(const std::string& url) { return url.substr(0, url.find_first_of("/?#", url.find("://") + 3)); }

using Set = std::function<void(const char* name, const std::string& value)>;

void set_rtsp(const UrlSettings& settings, const Set& set)
{
    set("protocol_whitelist", "tcp,udp,rtp");
    set("rtsp_transport", settings.transport);
    set("allowed_media_types", "video");
}

void set_http(const UrlSettings& settings, const Set& set)
{
    set("protocol_whitelist", "http,https,httpproxy,tls,tcp");
    set("seekable", "0");  // each seek is a new connection, and the stream says how many are needed
    if (!settings.limits.redirects)
        set("max_redirects", "0");
    if (!settings.url.starts_with("https"))
        return;
    set("tls_verify", "1");
    if (!settings.certificate.empty())
        set("ca_file", settings.certificate);
}

}  // namespace

UrlLimits UrlLimits::none()
{
    constexpr std::int64_t any = std::int64_t{1} << 40;
    return {.pixels = INT32_MAX,
            .bytes = any,
            .allocation = INT32_MAX,
            .rtsp_allocation = INT32_MAX,
            .reply = INT32_MAX,
            .streams = 1000,
            .scans = INT32_MAX,
            .redirects = true};
}

UrlSettings url_settings(const SourceSettings& settings)
{
    auto login = capture::read_credentials(settings.credentials, {user_variable, password_variable});
    if (login && !login->camera.empty() && camera_of(login->camera) != camera_of(settings.text))
        throw std::runtime_error("the login in " + settings.credentials + " is for " + camera_of(login->camera)
                                 + ", not for " + camera_of(settings.text));
    return {.url = settings.text,
            .login = std::move(login),
            .transport = settings.transport,
            .basic_over_http = settings.basic_over_http,
            .certificate = settings.certificate};
}

std::string with_login(const UrlSettings& settings)
{
    const auto& url = settings.url;
    const auto& login = settings.login;
    if (!login)
        return url;
    const auto host = url.find("://") + 3;
    return url.substr(0, host) + encoded(login->user) + ":" + encoded(login->password) + "@" + url.substr(host);
}

ReplyRules reply_rules(const UrlSettings& settings)
{
    ReplyRules rules;
    rules.rtsp = settings.url.starts_with("rtsp");
    rules.has_login = settings.login.has_value();
    rules.basic_allowed = settings.basic_over_http || settings.url.starts_with("https");
    rules.redirects_allowed = settings.limits.redirects;
    rules.max_content = settings.limits.reply;
    return rules;
}

AVDictionary* url_options(const UrlSettings& settings)
{
    AVDictionary* options = nullptr;
    const Set set = [&](const char* name, const std::string& value) { av_dict_set(&options, name, value.c_str(), 0); };
    set("format_whitelist", camera_formats);
    set("max_streams", std::to_string(settings.limits.streams));
    set("probesize", std::to_string(1 << 20));
    settings.url.starts_with("rtsp") ? set_rtsp(settings, set) : set_http(settings, set);
    return options;
}

}  // namespace camera
