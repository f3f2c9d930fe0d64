// libpng reports errors by longjmp, so objects with destructors live outside of the function that it leaves.
#include "png_pixels.hpp"

#include "exif.hpp"

#include <hive/error.hpp>

#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <string>

namespace hive::vision {
namespace {

constexpr std::array<std::uint8_t, 16> beginning{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                 0,    0,   0,   13,  'I',  'H',  'D',  'R'};

/// After the last row libpng inflates all remaining compressed data, up to a thousand bytes per byte. A valid stream
/// ends within a few.
constexpr std::size_t max_behind_last_row = 1024;
constexpr std::size_t max_exif = 64 * 1024;
constexpr png_uint_32 pixel_chunk = 0x49444154;  // IDAT

[[noreturn]] void malformed(const std::string& text) { throw Error(Errc::malformed, "PNG: " + text); }

/// libpng would skip a text before the header.
std::span<const std::uint8_t> with_header(std::span<const std::uint8_t> bytes)
{
    if (bytes.size() < beginning.size() || !std::ranges::equal(beginning, bytes.first(beginning.size())))
        malformed("does not start with a signature and an image header");
    return bytes;
}

/// The input of libpng, and its error.
class Reading {
public:
    explicit Reading(std::span<const std::uint8_t> bytes)
        : rest_(with_header(bytes)),
          png_(png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &Reading::on_error, [](png_structp, auto) {})),
          info_(png_ ? png_create_info_struct(png_) : nullptr)
    {
        if (!info_)
            throw Error(Errc::failed, "the PNG decoder could not be created");
        png_set_read_fn(png_, this, &Reading::on_read);
        png_set_user_limits(png_, PNG_UINT_31_MAX, PNG_UINT_31_MAX);  // the caller limits pixels, not sides
        // All but header, palette, transparency, pixels and EXIF are skipped.
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
        png_set_keep_unknown_chunks(png_, PNG_HANDLE_CHUNK_AS_DEFAULT, reinterpret_cast<png_const_bytep>("eXIf"), 1);
    }
    ~Reading() { png_destroy_read_struct(&png_, &info_, nullptr); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

    // These return false if libpng failed.
    bool header();
    bool rows(cv::Mat& image);  ///< after header()
    [[nodiscard]] PngSize size() const;
    [[nodiscard]] int orientation() const;
    [[nodiscard]] const std::string& problem() const { return problem_; }

private:
    void as_bgr();
    [[nodiscard]] bool has_last_row() const;
    [[noreturn]] static void on_error(png_structp png, png_const_charp text);
    static void on_read(png_structp png, png_bytep to, std::size_t size);

    std::span<const std::uint8_t> rest_;
    png_structp png_;
    png_infop info_;
    std::size_t behind_ = 0;
    std::string problem_;
};

void Reading::on_error(png_structp png, png_const_charp text)
{
    static_cast<Reading*>(png_get_error_ptr(png))->problem_ = text;
    png_longjmp(png, 1);
}

void Reading::on_read(png_structp png, png_bytep to, std::size_t size)
{
    auto& self = *static_cast<Reading*>(png_get_io_ptr(png));
    if (png_get_io_chunk_type(png) == pixel_chunk && self.has_last_row()
        && (self.behind_ += size) > max_behind_last_row)
        png_error(png, "more data than its pixels are");
    if (size > self.rest_.size())
        png_error(png, "cut short");
    std::memcpy(to, self.rest_.data(), size);
    self.rest_ = self.rest_.subspan(size);
}

bool Reading::has_last_row() const
{
    constexpr int passes = 7;
    const bool interlaced = png_get_interlace_type(png_, info_) != PNG_INTERLACE_NONE;
    const auto height = png_get_image_height(png_, info_);  // 0: the header is not read yet
    return height > 0
           && (interlaced ? png_get_current_pass_number(png_) >= passes : png_get_current_row_number(png_) >= height);
}

/// As cv::imdecode converts them.
void Reading::as_bgr()
{
    const auto color = png_get_color_type(png_, info_);
    const bool grey = (color & PNG_COLOR_MASK_COLOR) == 0;
    png_set_strip_16(png_);
    png_set_strip_alpha(png_);
    if (color == PNG_COLOR_TYPE_PALETTE)
        png_set_palette_to_rgb(png_);
    if (grey && png_get_bit_depth(png_, info_) < 8)
        png_set_expand_gray_1_2_4_to_8(png_);
    if (grey)
        png_set_gray_to_rgb(png_);
    else
        png_set_bgr(png_);
}

bool Reading::header()
{
    if (setjmp(png_jmpbuf(png_)) != 0)
        return false;
    png_read_info(png_, info_);
    return true;
}

PngSize Reading::size() const { return {png_get_image_width(png_, info_), png_get_image_height(png_, info_)}; }

/// In a JPEG the same bytes follow a signature.
int Reading::orientation() const
{
    png_uint_32 size = 0;
    png_bytep exif = nullptr;
    if (png_get_eXIf_1(png_, info_, &size, &exif) == 0 || size > max_exif)
        return 1;
    std::vector<std::uint8_t> marked{'E', 'x', 'i', 'f', 0, 0};
    marked.insert(marked.end(), exif, exif + size);
    return exif_orientation(marked);
}

bool Reading::rows(cv::Mat& image)
{
    if (setjmp(png_jmpbuf(png_)) != 0)
        return false;
    as_bgr();
    const int passes = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    if (png_get_rowbytes(png_, info_) != static_cast<std::size_t>(image.cols) * 3
        || png_get_image_height(png_, info_) != static_cast<png_uint_32>(image.rows))
        png_error(png_, "rows of another size than in its header");
    for (int pass = 0; pass < passes; ++pass)
        for (int y = 0; y < image.rows; ++y)
            png_read_row(png_, image.ptr(y), nullptr);
    png_read_end(png_, info_);
    return true;
}

}  // namespace

PngSize png_size(std::span<const std::uint8_t> bytes)
{
    Reading reading(bytes);
    if (!reading.header())
        malformed(reading.problem());
    return reading.size();
}

int read_png(std::span<const std::uint8_t> bytes, cv::Mat& image)
{
    Reading reading(bytes);
    if (!reading.header() || !reading.rows(image))
        malformed(reading.problem());
    return reading.orientation();
}

}  // namespace hive::vision
