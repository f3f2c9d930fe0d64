// Writes and reads plain JSON text.
#include <hive/name.hpp>
#include <hive/plain_text.hpp>

#include <algorithm>
#include <array>

namespace hive {

void PlainWriter::close()
{
    text_[begin_] = '{';  // replaces the first comma
    text_ += '}';
}

void PlainWriter::number(std::string_view key, std::int64_t value)
{
    std::array<char, 24> digits{};
    raw(key, {digits.data(), std::to_chars(digits.begin(), digits.end(), value).ptr});
}

void PlainWriter::string(std::string_view key, const std::string& value) { append_quoted(text_ += key, value); }

bool PlainReader::string(std::string& value)
{
    if (!skip("\""))
        return false;
    const auto end = static_cast<std::size_t>(std::ranges::find_if_not(rest_, is_plain) - rest_.begin());
    if (end > JsonLimits{}.string_bytes)
        return false;
    value.assign(rest_, 0, end);
    rest_.remove_prefix(end);
    return skip("\"");
}

bool PlainReader::name(std::string& value) { return string(value) && is_name(value); }

bool PlainReader::flag(bool& value)
{
    value = rest_.starts_with('t');
    return skip(value ? "true" : "false");
}

bool PlainReader::read(std::int64_t& number)
{
    const bool zero_first = rest_.starts_with('0'), negative = rest_.starts_with('-');
    const auto [end, problem] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    const auto digits = static_cast<std::size_t>(end - rest_.data());
    if (problem != std::errc() || negative || (zero_first && digits > 1))
        return false;
    rest_.remove_prefix(digits);
    return true;
}

}  // namespace hive
