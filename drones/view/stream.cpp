// Writes the parts of a multipart body. Sends the line that ends a part together with the part, because browsers show
// an image only at that line.
#include "stream.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace view {
namespace {

constexpr std::string_view boundary = "--picture\r\n", end = "\r\n--picture\r\n";

}  // namespace

bool Stream::begin_part(Exchange::Time now)
{
    auto newest = newest_(now);
    const bool first = !jpeg_;
    if (!newest.jpeg || (!first && newest.version == version_ && now - started_ < repeat_))
        return false;
    jpeg_ = std::move(newest.jpeg);
    version_ = newest.version;
    started_ = now;
    sent_ = 0;
    head_ = (first ? std::string(boundary) : std::string())
            + "Content-Type: image/jpeg\r\nContent-Length: " + std::to_string(jpeg_->size()) + "\r\n\r\n";
    return true;
}

std::size_t Stream::read(std::span<char> to, Exchange::Time now)
{
    if (!jpeg_ || sent_ == head_.size() + jpeg_->size() + end.size())
        if (!begin_part(now))
            return 0;
    const std::array<std::string_view, 3> pieces{
        head_, {reinterpret_cast<const char*>(jpeg_->data()), jpeg_->size()}, end};
    std::size_t before = 0, copied = 0;
    for (const auto piece : pieces) {
        if (sent_ >= before && sent_ < before + piece.size()) {
            const auto count = piece.copy(to.data() + copied, to.size() - copied, sent_ - before);
            copied += count;
            sent_ += count;
        }
        before += piece.size();
    }
    return copied;
}

}  // namespace view
