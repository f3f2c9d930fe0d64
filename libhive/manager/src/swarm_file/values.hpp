// The values of a swarm file while it is being read: each knows where it stands, and every mistake is written down.
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

/// The texts of a file and of those that it includes, one behind the other: each byte has a number of its own.
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

/// The mistakes of a file and of those that it includes.
class Mistakes {
public:
    explicit Mistakes(const Texts& texts) : texts_(texts) {}

    void at_value(const Value& value, const std::string& text, const std::string& advice = {});
    void at_key(const Value& value, const std::string& text, const std::string& advice = {});
    void at_byte(std::size_t byte, const std::string& path, const std::string& text, const std::string& advice = {});
    /// The words of an error.
    void at_value(const Value& value, const Error& error) { at_value(value, error.what(), error.advice()); }
    void at_key(const Value& value, const Error& error) { at_key(value, error.what(), error.advice()); }
    /// What is written down of this value from now on would only follow from what was.
    void no_more_at(const Value& value) { silent_.insert(value.place->value); }
    [[nodiscard]] std::size_t count() const noexcept { return found_.size(); }
    /// In the order of the file.
    std::vector<Mistake> take();

private:
    const Texts& texts_;
    std::multimap<std::size_t, Mistake> found_;  ///< by byte
    std::set<std::size_t> silent_;
};

/// An object whose keys are known. Reading a value of the wrong kind writes down a mistake and gives nothing.
class Members {
public:
    /// @param what  for mistakes: "a drone"
    Members(Mistakes& mistakes, Value object, std::string_view what, std::span<const std::string_view> keys);

    [[nodiscard]] std::optional<Value> find(std::string_view key) const;
    /// The same; that it is missing is a mistake.
    [[nodiscard]] std::optional<Value> require(std::string_view key);
    std::optional<std::string> text(std::string_view key);
    /// One of the words.
    std::optional<std::string> word(std::string_view key, std::span<const std::string_view> words);
    std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most);
    bool flag(std::string_view key);

    [[nodiscard]] const Value& object() const noexcept { return object_; }

private:
    Mistakes& mistakes_;
    Value object_;
    std::string what_;
};

/// The text that a value is; otherwise nothing, and a mistake: `"on" must be a text, not 3`.
std::optional<std::string> text_of(Mistakes& mistakes, const Value& value);
/// The texts of a value that is one, or a list of at least one; each with its place.
std::vector<std::pair<std::string, Value>> texts_of(Mistakes& mistakes, const Value& value);
/// How a value is shown in a mistake.
std::string shown(const Json& value);
/// Is it an object? Otherwise a mistake.
bool require_object(Mistakes& mistakes, const Value& value);
/// "a, b or c"
std::string listed(std::span<const std::string_view> words);

}  // namespace hive::swarm_file
