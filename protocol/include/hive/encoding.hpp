// The encodings that an output can send its events in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// A keyword that connections may ask for, with a number if it has numbers: "png", "jpeg:1" to "jpeg:100". Each output
/// defines what its numbers mean. A keyword without a number stands for every body of its type.
struct Encoding {
    std::string word;
    std::string type;                   ///< the media type of encoded bodies
    std::int64_t least = 0, most = -1;  ///< its numbers, inclusive; none where least > most
    bool operator==(const Encoding&) const = default;
};

/// Is this a valid encoding: a keyword of `a` to `z`, digits and `-`, optionally with `:` and a number?
bool is_encoding(std::string_view text);
/// The number of "jpeg:80".
std::optional<std::int64_t> number_of(std::string_view encoding);
/// As readable text: "jpeg, jpeg:1 to jpeg:100, png".
std::string in_words(const std::vector<Encoding>& encodings);
/// The encoding that `text` asks for. Throws Errc::invalid_argument; the advice lists the available ones.
const Encoding& encoding_named(const std::vector<Encoding>& encodings, std::string_view text);

}  // namespace hive
