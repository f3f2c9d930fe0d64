// Reads status lines and the few fields that FFmpeg would act on, in the ways in which FFmpeg reads them.
#include "reply_guard.hpp"

#include <shown_url.hpp>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <utility>

namespace camera {
namespace {

constexpr int unauthorized = 401;

bool starts_with(std::string_view text, std::string_view lower_case)
{
    const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == b; };
    return text.size() >= lower_case.size() && std::ranges::equal(text.substr(0, lower_case.size()), lower_case, same);
}

std::string_view without_leading(std::string_view space, std::string_view text)
{
    return text.substr(std::min(text.find_first_not_of(space), text.size()));
}

/// The status of "RTSP/1.0 302 Moved".
int status_of(std::string_view line)
{
    return std::atoi(std::string(line.substr(std::min(line.find(' '), line.size()))).c_str());
}

}  // namespace

void ReplyGuard::refuse(const std::string& reason)
{
    if (refusal_.empty())
        refusal_ = reason;
}

void ReplyGuard::take(std::string_view line)
{
    head_size_ += line.size() + 1;
    if (head_size_ > rules_.max_head)
        refuse("the head of its reply is larger than " + std::to_string(rules_.max_head / 1024) + " KiB");
    if (line.empty())
        judge_head();
    else if (!std::exchange(in_head_, true))
        start_reply(line);
    else if (const auto colon = line.find(':'); colon != std::string_view::npos)
        take_field(line.substr(0, colon), without_leading(" \t", line.substr(colon + 1)));
}

void ReplyGuard::start_reply(std::string_view status_line)
{
    status_ = status_of(status_line);
    location_.clear();
    offers_basic_ = offers_digest_ = false;
}

/// FFmpeg's HTTP skips more kinds of white space than its RTSP: basic counts as offered with any of them, digest only
/// with those of both.
void ReplyGuard::take_challenge(std::string_view value)
{
    offers_basic_ = offers_basic_ || starts_with(without_leading(" \t\r\n\v\f", value), "basic");
    offers_digest_ = offers_digest_ || starts_with(value, "digest ");
}

/// A length that does not fit into FFmpeg's int would overflow, so only lengths in range are accepted.
void ReplyGuard::take_field(std::string_view name, std::string_view value)
{
    const auto is = [&](std::string_view field) { return name.size() == field.size() && starts_with(name, field); };
    if (is("location"))
        location_ = value;
    else if (is("www-authenticate"))
        take_challenge(value);
    else if (rules_.rtsp && is("content-length")) {
        const long length = std::strtol(std::string(value).c_str(), nullptr, 10);
        if (length < 0 || length > rules_.max_content)
            refuse("it announces a reply of " + std::to_string(length) + " bytes; at most "
                   + std::to_string(rules_.max_content) + " are accepted");
    }
}

void ReplyGuard::judge_head()
{
    in_head_ = false;
    head_size_ = 0;
    const int status = std::exchange(status_, 0);
    if (status >= 300 && status < 400 && !rules_.redirects_allowed)
        refuse("it redirects to " + capture::shown_url(location_) + " (" + std::to_string(status)
               + "), which is not followed");
    if (status != unauthorized || !rules_.has_login)
        return;
    if (++challenges_ > rules_.max_challenges)
        refuse("it repeats its request for a login");
    if (offers_basic_ && !offers_digest_ && !rules_.basic_allowed)
        refuse("it accepts only an unencrypted password (basic authentication); use https, or set basic_over_http=on");
}

}  // namespace camera
