// The walk over the chunks of a PNG: every length is checked against the bytes that are there.
#include "png_structure.hpp"

#include "exif.hpp"

#include <hive/error.hpp>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

namespace hive::vision {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t signature_size = 8, around_data = 12;  // length, type and check sum of a chunk
constexpr std::array<std::uint8_t, 16> beginning{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                 0,    0,   0,   13,  'I',  'H',  'D',  'R'};

[[noreturn]] void malformed(const std::string& text) { throw Error(Errc::malformed, "PNG: " + text); }

std::uint32_t number(Bytes bytes)
{
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

struct Chunk {
    std::string_view type;
    Bytes data, whole;
    /// Must whoever does not know it give up?
    [[nodiscard]] bool critical() const { return type[0] >= 'A' && type[0] <= 'Z'; }
};

class Walk {
public:
    explicit Walk(Bytes bytes) : rest_(bytes.subspan(signature_size))
    {
        found_.bytes.reserve(bytes.size());
        keep(bytes.first(signature_size));
    }

    PngStructure run()
    {
        for (auto chunk = next(); chunk.type != "IEND"; chunk = next())
            take(chunk);
        return std::move(found_);
    }

private:
    void keep(Bytes bytes) { found_.bytes.insert(found_.bytes.end(), bytes.begin(), bytes.end()); }

    Chunk next()
    {
        if (rest_.size() < around_data || number(rest_) > rest_.size() - around_data)
            malformed("is cut short");
        const std::size_t size = number(rest_);
        const Bytes whole = rest_.first(size + around_data);
        rest_ = rest_.subspan(whole.size());
        const Chunk chunk{{reinterpret_cast<const char*>(whole.data()) + 4, 4}, whole.subspan(8, size), whole};
        if (chunk.critical())
            keep(whole);
        return chunk;
    }

    void take(const Chunk& chunk)
    {
        constexpr std::size_t most_transparency = 256, most_exif = 64 * 1024;
        if (chunk.type == "tRNS" && chunk.data.size() <= most_transparency)
            keep(chunk.whole);
        else if (chunk.type == "eXIf" && chunk.data.size() <= most_exif && !std::exchange(exif_, true))
            take_exif(chunk.data);
    }

    /// In a JPEG the same bytes stand behind a mark.
    void take_exif(Bytes data)
    {
        std::vector<std::uint8_t> marked{'E', 'x', 'i', 'f', 0, 0};
        marked.insert(marked.end(), data.begin(), data.end());
        found_.orientation = exif_orientation(marked);
    }

    Bytes rest_;
    PngStructure found_;
    bool exif_ = false;
};

}  // namespace

PngSize png_size(Bytes bytes)
{
    if (bytes.size() < signature_size + around_data + 13
        || !std::ranges::equal(beginning, bytes.first(beginning.size())))
        malformed("does not begin with a signature and an image header");
    const PngSize size{number(bytes.subspan(16)), number(bytes.subspan(20))};
    constexpr std::int64_t most = 0x7FFFFFFF;
    if (size.width < 1 || size.height < 1 || size.width > most || size.height > most)
        malformed("has no width or no height");
    return size;
}

PngStructure png_structure(Bytes bytes) { return Walk(bytes).run(); }

}  // namespace hive::vision
