// Follows a text that is being parsed, token by token, and records the positions of the values.
#pragma once

#include <hive/json_places.hpp>

namespace hive {

/// Called for every token except ':' and ',' after the parser has accepted it. The parser has checked the text so far,
/// so the end of a token is found without interpreting it.
class PlaceWriter {
public:
    explicit PlaceWriter(std::string_view text) : text_(text) {}

    void key(std::string_view name);
    void value();
    /// The last value is an object or an array, which contains the following values.
    void open(bool object);
    void close();

    /// The position of the next token.
    [[nodiscard]] std::size_t next_token() const noexcept;
    JsonPlace take() { return std::move(root_); }

private:
    struct Open {
        JsonPlace* place;
        bool object;
    };
    void advance();
    /// The place for the next value: the last member, or a new item.
    JsonPlace& slot();

    std::string_view text_;
    std::size_t token_ = 0, end_ = 0;  ///< of the last token
    JsonPlace root_;
    JsonPlace* last_ = &root_;  ///< the last value
    std::vector<Open> open_;    ///< outermost first; no vector grows while one of its items is open
};

}  // namespace hive
