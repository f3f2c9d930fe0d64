// Finds tokens in an accepted text, and lines and columns in any text.
#include "json_places.hpp"

#include <algorithm>

namespace hive {
namespace {

constexpr std::string_view brackets = "{}[]";
constexpr std::string_view between_tokens = " \t\r\n,:";
constexpr std::string_view ends_word = " \t\r\n,:{}[]\"/";  // ends a number, or true, false and null

std::size_t or_end(std::size_t found, std::string_view text) { return std::min(found, text.size()); }

/// The position after the closing quotation mark.
std::size_t end_of_string(std::string_view text, std::size_t begin)
{
    for (auto at = begin + 1; at < text.size(); ++at)
        if (text[at] == '"')
            return at + 1;
        else if (text[at] == '\\')
            ++at;
    return text.size();
}

}  // namespace

std::size_t PlaceWriter::next_token() const noexcept
{
    return or_end(text_.find_first_not_of(between_tokens, end_), text_);
}

void PlaceWriter::advance()
{
    token_ = next_token();
    if (token_ == text_.size())
        end_ = token_;
    else if (text_[token_] == '"')
        end_ = end_of_string(text_, token_);
    else if (brackets.find(text_[token_]) != std::string_view::npos)
        end_ = token_ + 1;
    else
        end_ = or_end(text_.find_first_of(ends_word, token_), text_);
}

void PlaceWriter::key(std::string_view name)
{
    advance();
    open_.back().place->members.emplace_back(name, JsonPlace{.key = token_});
}

JsonPlace& PlaceWriter::slot()
{
    if (open_.empty())
        return root_;
    auto& [place, object] = open_.back();
    return object ? place->members.back().second : place->items.emplace_back();
}

void PlaceWriter::value()
{
    advance();
    last_ = &slot();
    last_->value = token_;
    if (open_.empty() || !open_.back().object)
        last_->key = token_;
}

void PlaceWriter::open(bool object) { open_.push_back({last_, object}); }

void PlaceWriter::close()
{
    advance();
    open_.pop_back();
}

const JsonPlace* JsonPlace::member(std::string_view name) const noexcept
{
    const auto found = std::ranges::find(members, name, &std::pair<std::string, JsonPlace>::first);
    return found == members.end() ? nullptr : &found->second;
}

namespace {

constexpr std::size_t counted_every = 256;

std::size_t characters_in(std::string_view text)
{
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

TextLines::TextLines(std::string_view text) : text_(text)
{
    for (auto end = text.find('\n'); end != std::string_view::npos; end = text.find('\n', end + 1))
        begins_.push_back(end + 1);
    for (std::size_t i = 0; i + counted_every <= text.size(); i += counted_every)
        counted_.push_back(counted_.back() + characters_in(text.substr(i, counted_every)));
}

TextLines::Spot TextLines::at(std::size_t byte) const
{
    byte = std::min(byte, text_.size());
    const auto line = std::prev(std::ranges::upper_bound(begins_, byte));
    return {static_cast<std::size_t>(line - begins_.begin()) + 1,
            characters_before(byte) - characters_before(*line) + 1};
}

std::size_t TextLines::characters_before(std::size_t byte) const
{
    const auto block = byte / counted_every;
    return counted_[block] + characters_in(text_.substr(block * counted_every, byte % counted_every));
}

}  // namespace hive
