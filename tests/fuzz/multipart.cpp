// A camera's stream: fed whole and in slices it gives the same images and the same end, and what it gives came in the
// stream. Input: one byte for the slicing, the Content-Type up to a line feed, then the stream.
#include "multipart.hpp"

#include "require.hpp"
#include "camera_error.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace {

using hive::fuzz::require;

struct Given {
    std::vector<std::string> parts;
    std::string error;
};

void take(axis::MultipartReader& reader, Given& result)
{
    while (const auto part = reader.next())
        result.parts.push_back(part->type + "\n" + part->bytes);
}

/// @param most  bytes of a slice; 0: no slices
Given given(const std::string& boundary, std::string_view stream, unsigned seed, unsigned most)
{
    axis::MultipartReader reader(boundary);
    Given result;
    try {
        while (!stream.empty()) {
            seed = seed * 1103515245u + 12345u;
            const auto slice = stream.substr(0, most == 0 ? stream.size() : 1 + (seed >> 16) % most);
            reader.feed(slice);
            stream.remove_prefix(slice.size());
            take(reader, result);
        }
        reader.finish();
    } catch (const axis::CameraError& error) {
        result.error = error.what();
    }
    take(reader, result);
    return result;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    if (size == 0)
        return 0;
    std::string_view text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
    const auto line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    const auto boundary = axis::boundary_of(line);
    if (!boundary)
        return 0;
    const auto whole = given(*boundary, text, 0, 0), sliced = given(*boundary, text, bytes[0], 40);
    require(whole.parts == sliced.parts, "slices give the same parts");
    require(whole.error == sliced.error, "slices end as the whole does");
    std::size_t sum = 0;
    for (const auto& part : whole.parts)
        sum += part.size();
    require(sum <= 2 * text.size() + 16 * whole.parts.size(), "parts come from the stream");
    return 0;
}
