// The walk over the chunks of a PNG, and the count of what its pixels inflate to.
#include "png_structure.hpp"

#include <hive/error.hpp>

#include <zlib.h>

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

/// Samples of one pixel, or 0 for a kind of picture that does not exist (table 12 of the specification).
int samples(const PngHeader& header)
{
    const bool bytes = header.depth == 8 || header.depth == 16;
    const bool less = header.depth == 1 || header.depth == 2 || header.depth == 4;
    switch (header.color) {
    case 0: return bytes || less ? 1 : 0;
    case 2: return bytes ? 3 : 0;
    case 3: return header.depth == 8 || less ? 1 : 0;
    case 4: return bytes ? 2 : 0;
    case 6: return bytes ? 4 : 0;
    default: return 0;
    }
}

/// Bytes of so many pixels: rows of whole bytes, each with one more for its filter.
std::uint64_t rows_size(std::uint64_t width, std::uint64_t height, std::uint64_t bits)
{
    return width == 0 ? 0 : height * (1 + (width * bits + 7) / 8);
}

/// What the pixels are before they are compressed.
std::uint64_t pixels_size(const PngHeader& header)
{
    struct Pass {
        std::uint64_t left, top, across, down;
    };
    constexpr std::array<Pass, 7> interlaced{
        {{0, 0, 8, 8}, {4, 0, 8, 8}, {0, 4, 4, 8}, {2, 0, 4, 4}, {0, 2, 2, 4}, {1, 0, 2, 2}, {0, 1, 1, 2}}};
    const auto width = static_cast<std::uint64_t>(header.width), height = static_cast<std::uint64_t>(header.height);
    const auto bits = static_cast<std::uint64_t>(samples(header) * header.depth);
    if (header.interlace == 0)
        return rows_size(width, height, bits);
    std::uint64_t size = 0;
    for (const auto& pass : interlaced)
        size += rows_size((width + pass.across - 1 - pass.left) / pass.across,
                          (height + pass.down - 1 - pass.top) / pass.down, bits);
    return size;
}

/// Inflates the pixels into a scratch buffer, to count them.
class Inflation {
public:
    explicit Inflation(std::uint64_t most) : most_(most)
    {
        if (::inflateInit(&stream_) != Z_OK)
            throw Error(Errc::failed, "the PNG decoder could not be made");
    }
    ~Inflation() { ::inflateEnd(&stream_); }
    Inflation(const Inflation&) = delete;
    Inflation& operator=(const Inflation&) = delete;

    void feed(Bytes data)
    {
        stream_.next_in = const_cast<Bytef*>(data.data());
        stream_.avail_in = static_cast<uInt>(data.size());
        while (!ended_ && (stream_.avail_in > 0 || stream_.avail_out == 0))
            step();
        if (stream_.avail_in > 0)
            malformed("has data after its last pixel");
    }
    [[nodiscard]] bool complete() const { return ended_ && count_ == most_; }

private:
    void step()
    {
        stream_.next_out = scratch_.data();
        stream_.avail_out = static_cast<uInt>(scratch_.size());
        const int result = ::inflate(&stream_, Z_NO_FLUSH);
        if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR)
            malformed("its pixels are damaged");
        ended_ = result == Z_STREAM_END;
        count_ += scratch_.size() - stream_.avail_out;
        if (count_ > most_)
            malformed("has more data than its pixels are");
    }

    z_stream stream_{};
    std::array<Bytef, 32 * 1024> scratch_;
    const std::uint64_t most_;
    std::uint64_t count_ = 0;
    bool ended_ = false;
};

struct Chunk {
    std::string_view type;
    Bytes data, whole;
    /// Must whoever does not know it give up?
    [[nodiscard]] bool critical() const { return type[0] >= 'A' && type[0] <= 'Z'; }
};

class Walk {
public:
    Walk(Bytes bytes, const PngHeader& header) : rest_(bytes.subspan(signature_size)), pixels_(pixels_size(header))
    {
        needed_.reserve(bytes.size());
        keep(bytes.first(signature_size));
    }

    std::vector<std::uint8_t> run()
    {
        for (auto chunk = next(); chunk.type != "IEND"; chunk = next())
            take(chunk);
        if (!pixels_.complete())
            malformed("ends before its last pixel");
        return std::move(needed_);
    }

private:
    void keep(Bytes bytes) { needed_.insert(needed_.end(), bytes.begin(), bytes.end()); }

    Chunk next()
    {
        if (rest_.size() < around_data || number(rest_) > rest_.size() - around_data)
            malformed("is cut short");
        const std::size_t size = number(rest_);
        const Bytes whole = rest_.first(size + around_data);
        rest_ = rest_.subspan(whole.size());
        const Chunk chunk{{reinterpret_cast<const char*>(whole.data()) + 4, 4}, whole.subspan(8, size), whole};
        if (chunk.critical()) {
            require_whole(chunk);
            keep(whole);
        }
        return chunk;
    }

    static void require_whole(const Chunk& chunk)
    {
        const Bytes summed = chunk.whole.subspan(4, chunk.data.size() + 4);
        if (::crc32_z(0, summed.data(), summed.size()) != number(chunk.whole.last(4)))
            malformed("is damaged");
    }

    void take(const Chunk& chunk)
    {
        if (chunk.type == "IDAT")
            pixels_.feed(chunk.data);
        else if (chunk.critical() && chunk.type != "IHDR" && chunk.type != "PLTE")
            malformed("has a chunk that no decoder knows");
        else if ((chunk.type == "tRNS" && chunk.data.size() <= most_transparency)
                 || (chunk.type == "eXIf" && chunk.data.size() <= most_exif && !std::exchange(exif_, true)))
            keep(chunk.whole);
    }

    static constexpr std::size_t most_transparency = 256, most_exif = 64 * 1024;
    Bytes rest_;
    Inflation pixels_;
    std::vector<std::uint8_t> needed_;
    bool exif_ = false;
};

}  // namespace

PngHeader png_header(Bytes bytes)
{
    if (bytes.size() < signature_size + around_data + 13
        || !std::ranges::equal(beginning, bytes.first(beginning.size())))
        malformed("does not begin with a signature and an image header");
    const PngHeader header{
        number(bytes.subspan(16)), number(bytes.subspan(20)), bytes[24], bytes[25], bytes[26], bytes[27], bytes[28]};
    constexpr std::int64_t most = 0x7FFFFFFF;
    if (header.width < 1 || header.height < 1 || header.width > most || header.height > most)
        malformed("has no width or no height");
    return header;
}

std::vector<std::uint8_t> only_the_picture(Bytes bytes, const PngHeader& header)
{
    if (samples(header) == 0 || header.compression != 0 || header.filter != 0 || header.interlace > 1)
        malformed("is of a kind that does not exist");
    return Walk(bytes, header).run();
}

}  // namespace hive::vision
