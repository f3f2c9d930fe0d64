#include "token.hpp"

#include "words/file_text.hpp"

#include <hive/error.hpp>
#include <hive/http/pass.hpp>
#include <hive/platform/whole_file.hpp>

namespace hivectl::dash {

/// Never replaces one, so that two processes that start at once get the same token.
std::string lasting_token(const std::filesystem::path& file)
{
    constexpr std::size_t max_bytes = 64, length = 32;
    const auto problem = hive::platform::write_whole(file, hive::http::Pass::draw_token(), {.replaces = false});
    if (problem && problem != std::errc::file_exists)
        throw hive::Error(hive::Errc::io, "cannot write " + file.string() + ": " + problem.message());
    auto kept = text_of_file(file.string(), max_bytes);
    if (kept.size() != length)
        throw hive::Error(hive::Errc::malformed, file.string() + " holds no token", "remove it: rm " + file.string());
    return kept;
}

}  // namespace hivectl::dash
