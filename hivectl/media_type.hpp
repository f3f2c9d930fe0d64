// File endings and the media types they stand for.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hivectl {

/// "image/jpeg" for "a.JPG"; empty for an ending that is not known.
std::string media_type_of(const std::filesystem::path& file);
/// ".jpg" of "image/jpeg"; empty for a type that is not known.
std::string ending_of(std::string_view type);
/// True when the ending stands for that type, or when the ending or the type says nothing.
bool ending_fits(const std::filesystem::path& file, std::string_view type);

}  // namespace hivectl
