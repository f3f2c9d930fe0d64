// Walks the protocol buffers of a file; the numbers of the fields are those of onnx.proto.
#include "onnx_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <tuple>
#include <utility>

namespace detect {
namespace {

constexpr std::uint64_t longest_text = 1 << 20;
constexpr int largest_side = 4096;
constexpr std::size_t max_names = 10'000, max_task = 32, max_operator = 64, max_operators = 200;
constexpr int max_keypoints = 1000;

/// Iterates over the fields of one message. Any error ends the iteration.
class Fields {
public:
    Fields(std::istream& file, std::uint64_t length)
        : file_(file), end_(static_cast<std::uint64_t>(file.tellg()) + length)
    {
    }

    /// Goes to the next field, skipping the unread part of the last one.
    bool next()
    {
        if (!file_.seekg(static_cast<std::streamoff>(after_ ? after_ : here())) || here() >= end_)
            return false;
        const auto key = varint();
        if (!key)
            return false;
        number = static_cast<int>(*key >> 3);
        switch (*key & 7) {
        case 0: value = varint().value_or(0); break;
        case 1: value = 8; return leap(8);
        case 2: value = varint().value_or(0); return leap(value);
        case 5: value = 4; return leap(4);
        default: return false;
        }
        after_ = here();
        return static_cast<bool>(file_);
    }

    /// The message in a field; not to be used after the next next().
    Fields inside() { return {file_, value}; }
    std::string text()
    {
        std::string bytes(value <= longest_text ? value : 0, '\0');
        file_.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return file_ ? bytes : std::string();
    }

    int number = 0;
    std::uint64_t value = 0;  ///< of a number; of anything else its length in bytes

private:
    [[nodiscard]] std::uint64_t here() { return static_cast<std::uint64_t>(file_.tellg()); }

    bool leap(std::uint64_t length)
    {
        if (!file_ || length > end_ - std::min(end_, here()))
            return false;
        after_ = here() + length;
        return true;
    }

    std::optional<std::uint64_t> varint()
    {
        std::uint64_t result = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const int byte = file_.get();
            if (byte < 0)
                return std::nullopt;
            result |= static_cast<std::uint64_t>(byte & 127) << shift;
            if (byte < 128)
                return result;
        }
        return std::nullopt;
    }

    std::istream& file_;
    std::uint64_t end_, after_ = 0;
};

/// TensorShapeProto: dim = 1; Dimension: dim_value = 1.
std::vector<std::int64_t> shape_in(Fields shape)
{
    std::vector<std::int64_t> sides;
    while (shape.next())
        if (shape.number == 1) {
            sides.push_back(0);
            for (Fields side = shape.inside(); side.next();)
                if (side.number == 1)
                    sides.back() = static_cast<std::int64_t>(side.value);
        }
    return sides;
}

/// ValueInfoProto: type = 2; TypeProto: tensor_type = 1; Tensor: shape = 2.
std::vector<std::int64_t> shape_of_value(Fields value)
{
    while (value.next())
        if (value.number == 2)
            for (Fields type = value.inside(); type.next();)
                if (type.number == 1)
                    for (Fields tensor = type.inside(); tensor.next();)
                        if (tensor.number == 2)
                            return shape_in(tensor.inside());
    return {};
}

/// StringStringEntryProto: key = 1, value = 2.
std::pair<std::string, std::string> entry(Fields fields)
{
    std::pair<std::string, std::string> result;
    while (fields.next())
        if (fields.number == 1 || fields.number == 2)
            (fields.number == 1 ? result.first : result.second) = fields.text();
    return result;
}

bool is_side(std::int64_t side) { return side > 0 && side <= largest_side; }

/// NodeProto: op_type = 4.
void add_operator(Fields node, std::vector<std::string>& names)
{
    while (node.next())
        if (node.number == 4 && node.value <= max_operator && names.size() < max_operators)
            if (auto name = node.text(); std::ranges::find(names, name) == names.end())
                names.push_back(std::move(name));
}

/// GraphProto: node = 1, input = 11, the first of which that has four sides is the image: 1, 3, height, width.
void read_graph(Fields graph, ModelCard& card)
{
    while (graph.next())
        if (graph.number == 1)
            add_operator(graph.inside(), card.operators);
        else if (graph.number == 11 && card.input.empty())
            if (const auto sides = shape_of_value(graph.inside());
                sides.size() == 4 && sides[0] <= 1 && sides[1] == 3 && is_side(sides[2]) && is_side(sides[3]))
                card.input = {static_cast<int>(sides[3]), static_cast<int>(sides[2])};
}

}  // namespace

std::vector<std::string> names_from(const std::string& text)
{
    std::vector<std::string> names;
    std::size_t at = 0;
    const auto blanks = [&] {
        while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])))
            ++at;
    };
    const auto take = [&](char letter) {
        blanks();
        return at < text.size() && text[at] == letter ? ++at > 0 : false;
    };
    if (!take('{'))
        return {};
    while (!take('}')) {
        blanks();
        std::string number;
        while (at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])))
            number += text[at++];
        if (number != std::to_string(names.size()) || names.size() == max_names || !take(':'))
            return {};
        blanks();
        const char quote = at < text.size() ? text[at++] : 0;
        const auto end = text.find(quote, at);
        if ((quote != '\'' && quote != '"') || end == std::string::npos)
            return {};
        names.push_back(text.substr(at, end - at));
        at = end + 1;
        if (!take(',') && (blanks(), at >= text.size() || text[at] != '}'))
            return {};
    }
    return names;
}

std::optional<std::pair<int, int>> keypoints_from(const std::string& text)
{
    int count = 0, numbers = 0, end = 0;
    const int read = std::sscanf(text.c_str(), " [ %5d , %5d ] %n", &count, &numbers, &end);
    const bool whole = read == 2 && end == static_cast<int>(text.size());
    return whole && count > 0 && count <= max_keypoints && (numbers == 2 || numbers == 3)
               ? std::optional(std::pair(count, numbers))
               : std::nullopt;
}

/// ModelProto: graph = 7, metadata_props = 14.
ModelCard model_card(const std::string& path)
{
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto size = file.tellg();
    file.seekg(0);
    ModelCard card;
    if (!file || size <= 0)
        return card;
    for (Fields model(file, static_cast<std::uint64_t>(size)); model.next();)
        if (model.number == 7)
            read_graph(model.inside(), card);
        else if (model.number == 14) {
            const auto [key, value] = entry(model.inside());
            if (key == "names")
                card.names = names_from(value);
            else if (key == "task" && value.size() <= max_task)
                card.task = value;
            else if (const auto shape = key == "kpt_shape" ? keypoints_from(value) : std::nullopt)
                std::tie(card.keypoints, card.numbers) = *shape;
        }
    return card;
}

}  // namespace detect
