// Options of FFmpeg for a network camera, and the rules for its replies.
#pragma once

#include "reply_guard.hpp"
#include "video_source.hpp"

#include <ffmpeg.hpp>

#include <string>

namespace camera {

/// The URL with the login in it, as FFmpeg takes it.
std::string with_login(const UrlSettings& settings);
ReplyRules reply_rules(const UrlSettings& settings);
/// FFmpeg's own limits, and how the camera is reached. The caller frees the dictionary.
AVDictionary* url_options(const UrlSettings& settings);

}  // namespace camera
