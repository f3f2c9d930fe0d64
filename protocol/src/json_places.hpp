// Follows a text that is being parsed, token by token, and writes down where the values begin.
#pragma once

#include <hive/json_places.hpp>

namespace hive {

/// Told of every token but ':' and ',' when the parser has accepted it. The parser has checked the text up to there, so
/// the end of a token is found without looking at what it says.
class PlaceWriter {
public:
    explicit PlaceWriter(std::string_view text) : text_(text) {}

    void key(std::string_view name);
    void value();
    /// The value that was told of last is an object or an array: what follows is in it.
    void open(bool object);
    void close();

    /// Where the next token would begin.
    [[nodiscard]] std::size_t next_token() const noexcept;
    JsonPlace take() { return std::move(root_); }

private:
    struct Open {
        JsonPlace* place;
        bool object;
    };
    void advance();
    /// Where the next value is written down: the last member, or a new item.
    JsonPlace& slot();

    std::string_view text_;
    std::size_t token_ = 0, end_ = 0;  ///< of the token that was told of last
    JsonPlace root_;
    JsonPlace* last_ = &root_;  ///< the value that was told of last
    std::vector<Open> open_;    ///< outermost first; no vector grows while one of its items is open
};

}  // namespace hive
