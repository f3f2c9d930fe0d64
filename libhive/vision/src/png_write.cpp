// Writes PNG with libpng, which reports errors by longjmp: objects with destructors live outside of the function that
// it leaves.
#include "png_pixels.hpp"

#include <hive/error.hpp>

#include <png.h>

#include <bit>
#include <csetjmp>
#include <new>
#include <string>
#include <utility>

namespace hive::vision {
namespace {

constexpr int best_speed = 1, run_lengths = 3;  // zlib's level and strategy

/// One image being written, and the error that libpng reported.
class Writing {
public:
    Writing()
        : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, this, &Writing::on_error, [](png_structp, auto) {})),
          info_(png_ ? png_create_info_struct(png_) : nullptr)
    {
        if (!info_) {
            png_destroy_write_struct(&png_, nullptr);
            throw Error(Errc::failed, "the PNG encoder could not be created");
        }
        png_set_write_fn(png_, this, &Writing::on_write, nullptr);
    }
    ~Writing() { png_destroy_write_struct(&png_, &info_); }
    Writing(const Writing&) = delete;
    Writing& operator=(const Writing&) = delete;

    /// False if libpng failed.
    bool rows(const cv::Mat& image);
    [[nodiscard]] std::vector<unsigned char> take_bytes() { return std::move(bytes_); }
    [[nodiscard]] const std::string& problem() const { return problem_; }

private:
    void header(const cv::Mat& image);
    [[nodiscard]] bool append(png_const_bytep from, std::size_t size) noexcept;
    [[noreturn]] static void on_error(png_structp png, png_const_charp text);
    static void on_write(png_structp png, png_bytep from, std::size_t size);

    png_structp png_;
    png_infop info_;
    std::vector<unsigned char> bytes_;
    std::string problem_;
};

void Writing::on_error(png_structp png, png_const_charp text)
{
    static_cast<Writing*>(png_get_error_ptr(png))->problem_ = text;
    png_longjmp(png, 1);
}

void Writing::on_write(png_structp png, png_bytep from, std::size_t size)
{
    if (!static_cast<Writing*>(png_get_io_ptr(png))->append(from, size))
        png_error(png, "out of memory");
}

bool Writing::append(png_const_bytep from, std::size_t size) noexcept
try {
    bytes_.insert(bytes_.end(), from, from + size);
    return true;
} catch (const std::bad_alloc&) {
    return false;
}

/// Fast rather than small, as cv::imencode.
void Writing::header(const cv::Mat& image)
{
    const bool grey = image.channels() == 1;
    const int bits = image.depth() == CV_16U ? 16 : 8;
    png_set_filter(png_, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png_, best_speed);
    png_set_compression_strategy(png_, run_lengths);
    png_set_IHDR(png_, info_, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows), bits,
                 grey ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png_, info_);
    png_set_bgr(png_);
    if (std::endian::native == std::endian::little)
        png_set_swap(png_);
}

bool Writing::rows(const cv::Mat& image)
{
    if (setjmp(png_jmpbuf(png_)) != 0)
        return false;
    header(image);
    for (int y = 0; y < image.rows; ++y)
        png_write_row(png_, image.ptr(y));
    png_write_end(png_, info_);
    return true;
}

}  // namespace

std::vector<unsigned char> write_png(const cv::Mat& image)
{
    Writing writing;
    if (!writing.rows(image))
        throw Error(Errc::failed, "PNG: " + writing.problem());
    return writing.take_bytes();
}

}  // namespace hive::vision
