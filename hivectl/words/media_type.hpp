// Maps file extensions to media types.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hivectl {

/// "image/jpeg" for "a.JPG"; empty for an unknown extension.
std::string media_type_of(const std::filesystem::path& file);
/// ".jpg" of "image/jpeg"; empty for an unknown type.
std::string ending_of(std::string_view type);
/// Does the extension match the type? True if either is unknown.
bool ending_fits(const std::filesystem::path& file, std::string_view type);

}  // namespace hivectl
