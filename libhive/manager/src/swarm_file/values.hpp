// The values of a swarm file while it is read: each has its position, and every error is recorded.
#pragma once

#include <hive/json_places.hpp>
#include <hive/swarm_plan.hpp>

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hive::swarm_file {

/// One value of the file. What it points to belongs to the parsed text.
struct Value {
    const Json* json = nullptr;
    const JsonPlace* place = nullptr;
    std::string path;  ///< "drones.face.set.scale"

    [[nodiscard]] Value member(const std::string& key, const JsonPlace& at) const;
    [[nodiscard]] Value item(std::size_t index) const;
};

/// The texts of a file and its includes, concatenated: each byte has its own number.
class Texts {
public:
    /// @param file  empty: the file itself
    /// @return      the number of the first byte
    std::size_t add(const std::string& file, std::string text);

    struct Spot {
        std::string file;
        std::size_t line, column;
    };
    [[nodiscard]] Spot at(std::size_t byte) const;

private:
    struct Text {
        Text(std::string name, std::size_t first, std::string content)
            : file(std::move(name)), begin(first), text(std::move(content)), lines(text)
        {
        }
        Text(const Text&) = delete;
        Text& operator=(const Text&) = delete;

        std::string file;
        std::size_t begin;
        std::string text;
        TextLines lines;
    };
    std::deque<Text> texts_;
};

/// The errors of a file and its includes.
class Mistakes {
public:
    explicit Mistakes(const Texts& texts) : texts_(texts) {}

    void at_value(const Value& value, const std::string& text, const std::string& advice = {});
    void at_key(const Value& value, const std::string& text, const std::string& advice = {});
    void at_byte(std::size_t byte, const std::string& path, const std::string& text, const std::string& advice = {});
    /// Adds the text of an error.
    void at_value(const Value& value, const Error& error) { at_value(value, error.what(), error.advice()); }
    void at_key(const Value& value, const Error& error) { at_key(value, error.what(), error.advice()); }
    /// Ignores further errors of this value: they would only follow from earlier ones.
    void no_more_at(const Value& value) { silent_.insert(value.place->value); }
    [[nodiscard]] std::size_t count() const noexcept { return found_.size(); }
    /// In the order of the file.
    std::vector<Mistake> take();

private:
    const Texts& texts_;
    std::multimap<std::size_t, Mistake> found_;  ///< by byte
    std::set<std::size_t> silent_;
};

/// An object with a fixed set of keys. Reading a value of the wrong type records an error and returns nothing.
class Members {
public:
    /// @param what  for errors: "a drone"
    Members(Mistakes& mistakes, Value object, std::string_view what, std::span<const std::string_view> keys);

    [[nodiscard]] std::optional<Value> find(std::string_view key) const;
    /// The same; a missing value is an error.
    [[nodiscard]] std::optional<Value> require(std::string_view key);
    std::optional<std::string> text(std::string_view key);
    /// One of the keywords.
    std::optional<std::string> word(std::string_view key, std::span<const std::string_view> words);
    std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most);
    bool flag(std::string_view key);

    [[nodiscard]] const Value& object() const noexcept { return object_; }

private:
    Mistakes& mistakes_;
    Value object_;
    std::string what_;
};

/// The value as text; otherwise nothing, and an error: `"on" must be a text, not 3`.
std::optional<std::string> text_of(Mistakes& mistakes, const Value& value);
/// The texts of a text or a non-empty list of texts, each with its position.
std::vector<std::pair<std::string, Value>> texts_of(Mistakes& mistakes, const Value& value);
/// A value as errors show it.
std::string shown(const Json& value);
/// Is it an object? Records an error otherwise.
bool require_object(Mistakes& mistakes, const Value& value);
/// "a, b or c"
std::string listed(std::span<const std::string_view> words);

}  // namespace hive::swarm_file
