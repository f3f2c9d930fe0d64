// The encodings in which an output can give its events.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hive {

/// A word that connections may ask for, with a number behind it if it has numbers: "png", "jpeg:1" to "jpeg:100". What
/// the numbers mean, each output knows itself. A word without a number stands for every body of its type.
struct Encoding {
    std::string word;
    std::string type;                   ///< the media type that it gives
    std::int64_t least = 0, most = -1;  ///< its numbers, inclusive; none where least > most
    bool operator==(const Encoding&) const = default;
};

/// May an encoding be written so: a word of `a` to `z`, digits and `-`, with `:` and a number if wanted?
bool is_encoding(std::string_view text);
/// The number of "jpeg:80".
std::optional<std::int64_t> number_of(std::string_view encoding);
/// As people read them: "jpeg, jpeg:1 to jpeg:100, png".
std::string in_words(const std::vector<Encoding>& encodings);
/// The one that `text` asks for. Throws Errc::invalid_argument; the advice lists what there is.
const Encoding& encoding_named(const std::vector<Encoding>& encodings, std::string_view text);

}  // namespace hive
