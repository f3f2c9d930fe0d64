// Writes and reads frequent JSON objects directly as text, without a JSON value in between.
#pragma once

#include <hive/json.hpp>

#include <array>
#include <charconv>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// The characters that stand for themselves in a JSON string.
inline constexpr auto plain_characters = [] {
    std::array<bool, 256> plain{};
    for (std::size_t c = ' '; c <= '~'; ++c)
        plain[c] = c != '"' && c != '\\';
    return plain;
}();
inline bool is_plain(char c) { return plain_characters[static_cast<unsigned char>(c)]; }

/// Appends a JSON string.
void append_quoted(std::string& text, const std::string& value);

/// Appends the fields of one object to `text`; keys are passed with their punctuation, `,"epoch":`.
class PlainWriter {
public:
    explicit PlainWriter(std::string& text) : text_(text), begin_(text.size()) {}
    void close();

    void raw(std::string_view key, std::string_view value) { (text_ += key) += value; }
    void number(std::string_view key, std::int64_t value);
    void string(std::string_view key, const std::string& value);

private:
    std::string& text_;
    std::size_t begin_;
};

/// A position in a text without white space and escapes. Each function advances if it finds what it expects, and
/// returns false otherwise: then the full JSON parser must read the text.
class PlainReader {
public:
    explicit PlainReader(std::string_view rest) : rest_(rest) {}

    [[nodiscard]] bool at_end() const { return rest_.empty(); }
    [[nodiscard]] std::string_view rest() const { return rest_; }
    bool skip(std::string_view word)
    {
        if (!rest_.starts_with(word))
            return false;
        rest_.remove_prefix(word.size());
        return true;
    }
    void leave_out(std::size_t bytes) { rest_.remove_prefix(bytes); }
    bool string(std::string& value);
    bool name(std::string& value);
    bool flag(bool& value);
    /// From 0 to `most`.
    template <class Integer>
    bool integer(Integer& value, std::int64_t most = max_json_integer)
    {
        std::int64_t number = 0;
        if (!read(number) || number > most)
            return false;
        value = static_cast<Integer>(number);
        return true;
    }

private:
    bool read(std::int64_t& number);

    std::string_view rest_;
};

}  // namespace hive
