// Parses a multipart stream in four phases.
#include "multipart.hpp"

#include "camera_error.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

namespace axis {
namespace {

std::string lower(std::string_view text)
{
    std::string result(text);
    std::ranges::transform(result, result.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return result;
}

std::string_view trimmed(std::string_view text)
{
    const auto first = text.find_first_not_of(" \t\r\n");
    return first == std::string_view::npos ? std::string_view()
                                           : text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::optional<std::size_t> number(std::string_view text)
{
    std::size_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem == std::errc::result_out_of_range)
        return MultipartReader::max_part + 1;
    return problem == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::string_view without_dashes(std::string_view name)
{
    return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

}  // namespace

std::optional<std::string> boundary_of(std::string_view content_type)
{
    const std::string low = lower(content_type);
    const std::size_t begin = low.find("boundary=");
    if (!trimmed(low).starts_with("multipart/") || begin == std::string::npos)
        return std::nullopt;
    std::string_view name = trimmed(content_type.substr(begin + 9));
    if (name.starts_with('"'))
        name = name.substr(1, name.find('"', 1) - 1);
    else
        name = trimmed(name.substr(0, name.find(';')));
    return without_dashes(name).empty() ? std::nullopt : std::optional(std::string(name));
}

MultipartReader::MultipartReader(std::string_view boundary) : boundary_("--" + std::string(without_dashes(boundary))) {}

void MultipartReader::feed(std::string_view bytes)
{
    buffer_ += bytes;
    while (step()) {
    }
}

void MultipartReader::finish()
{
    if (phase_ == Phase::open && !buffer_.empty())
        give(buffer_.size());
    buffer_.clear();
    phase_ = Phase::between;
}

std::optional<Part> MultipartReader::next()
{
    if (parts_.empty())
        return std::nullopt;
    Part part = std::move(parts_.front());
    parts_.pop_front();
    return part;
}

bool MultipartReader::step()
{
    switch (phase_) {
    case Phase::between: return seek();
    case Phase::head: return read_head();
    case Phase::counted: return read_counted();
    case Phase::open: return read_open();
    }
    return false;
}

bool MultipartReader::seek()
{
    const std::size_t at = buffer_.find(boundary_);
    if (at != std::string::npos)
        return pass_boundary(at);
    const std::size_t useless = buffer_.size() - std::min(buffer_.size(), boundary_.size() - 1);
    drop(useless);
    skipped_ += useless;
    if (skipped_ > max_part)
        throw CameraError(Failure::not_an_image, "not an image: no boundary in 16 MiB of the stream");
    return false;
}

/// Skips the line of the boundary; false until its end has arrived.
bool MultipartReader::pass_boundary(std::size_t at)
{
    const std::size_t end = buffer_.find('\n', at);
    if (end == std::string::npos) {
        if (buffer_.size() - at > max_head)
            throw CameraError(Failure::too_large, "a head of more than 8 KiB in the stream");
        return false;
    }
    drop(end + 1);
    phase_ = Phase::head;
    head_.clear();
    head_size_ = skipped_ = 0;
    return true;
}

bool MultipartReader::read_head()
{
    const std::size_t end = buffer_.find('\n');
    if (head_size_ + std::min(end, buffer_.size()) > max_head)
        throw CameraError(Failure::too_large, "a head of more than 8 KiB in the stream");
    if (end == std::string::npos)
        return false;
    const std::string_view line = trimmed(std::string_view(buffer_).substr(0, end));
    head_size_ += end + 1;
    if (const std::size_t colon = line.find(':'); colon != std::string_view::npos)
        head_[lower(line.substr(0, colon))] = trimmed(line.substr(colon + 1));
    const bool last = line.empty() && !head_.empty();
    drop(end + 1);
    if (last)
        begin_body();
    return true;
}

void MultipartReader::begin_body()
{
    const std::size_t length = number(head_["content-length"]).value_or(0);
    if (length > max_part)
        throw CameraError(Failure::too_large, "the camera announces an image of more than 16 MiB");
    phase_ = length > 0 ? Phase::counted : Phase::open;
    length_ = length;
    seen_ = 0;
}

bool MultipartReader::read_counted()
{
    if (buffer_.size() < length_)
        return false;
    give(length_);
    phase_ = Phase::between;
    return true;
}

bool MultipartReader::read_open()
{
    const std::size_t at = buffer_.find(boundary_, seen_);
    if (std::min(at, buffer_.size()) > max_part)
        throw CameraError(Failure::too_large, "an image of more than 16 MiB");
    if (at == std::string::npos) {
        seen_ = buffer_.size() - std::min(buffer_.size(), boundary_.size() - 1);
        return false;
    }
    std::size_t end = at;
    while (end > 0 && buffer_[end - 1] == '-')  // of a boundary with additional dashes
        --end;
    if (end > 0 && buffer_[end - 1] == '\n')
        --end;
    if (end > 0 && buffer_[end - 1] == '\r')
        --end;
    const std::size_t rest = at - end;
    give(end);
    drop(rest);
    phase_ = Phase::between;
    return true;
}

void MultipartReader::give(std::size_t size)
{
    parts_.push_back({lower(head_["content-type"]), buffer_.substr(0, size)});
    drop(size);
}

void MultipartReader::drop(std::size_t size) { buffer_.erase(0, size); }

}  // namespace axis
