// Parses encodings.
#include <hive/encoding.hpp>
#include <hive/error.hpp>

#include <algorithm>
#include <charconv>

namespace hive {
namespace {

std::string_view word_of(std::string_view encoding) { return encoding.substr(0, encoding.find(':')); }

}  // namespace

bool is_encoding(std::string_view text)
{
    constexpr std::size_t longest_word = 32, most_digits = 6;
    const auto all = [](std::string_view part, std::size_t most, auto fits) {
        return !part.empty() && part.size() <= most && std::ranges::all_of(part, fits);
    };
    const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    const auto word = word_of(text);
    return all(word, longest_word, [&](char c) { return lower(c) || digit(c) || c == '-'; }) && lower(word.front())
           && (word.size() == text.size() || all(text.substr(word.size() + 1), most_digits, digit));
}

std::optional<std::int64_t> number_of(std::string_view encoding)
{
    const auto digits = encoding.substr(std::min(word_of(encoding).size() + 1, encoding.size()));
    std::int64_t number = 0;
    const char* const end = digits.data() + digits.size();
    const auto [rest, problem] = std::from_chars(digits.data(), end, number);
    return problem == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

std::string in_words(const std::vector<Encoding>& encodings)
{
    std::string words;
    for (const auto& [word, type, least, most] : encodings) {
        words += (words.empty() ? "" : ", ") + word;
        if (least <= most)
            words += ", " + word + ":" + std::to_string(least) + " to " + word + ":" + std::to_string(most);
    }
    return words;
}

const Encoding& encoding_named(const std::vector<Encoding>& encodings, std::string_view text)
{
    const auto found = std::ranges::find(encodings, word_of(text), &Encoding::word);
    if (found != encodings.end()) {
        const auto number = number_of(text);
        if (text == found->word || (number && *number >= found->least && *number <= found->most))
            return *found;
    }
    throw Error(Errc::invalid_argument, "there is no encoding " + in_quotes(text), "there are " + in_words(encodings));
}

}  // namespace hive
