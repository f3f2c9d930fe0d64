// Protocol buffers by hand: the few fields of onnx.proto that a graph of three nodes needs, by their numbers there.
#include "onnx_writer.hpp"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace onnx {
namespace {

std::string varint(std::uint64_t value)
{
    std::string bytes;
    for (; value >= 128; value >>= 7)
        bytes += static_cast<char>(value % 128 + 128);
    return bytes + static_cast<char>(value);
}

std::string number(int field, std::uint64_t value)
{
    return varint(static_cast<std::uint64_t>(field) << 3) + varint(value);
}

/// A string, or a message inside a message.
std::string part(int field, const std::string& bytes)
{
    return varint(static_cast<std::uint64_t>(field) << 3 | 2) + varint(bytes.size()) + bytes;
}

template <class Number>
std::string raw(const std::vector<Number>& numbers)
{
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

std::string tensor(const std::string& name, int type, const std::vector<std::uint64_t>& sides,
                   const std::string& contents)
{
    std::string bytes;
    for (const auto side : sides)
        bytes += number(1, side);
    return bytes + number(2, static_cast<std::uint64_t>(type)) + part(8, name) + part(9, contents);
}

constexpr int type_float = 1, type_int64 = 7;

std::string value_info(const std::string& name, const std::vector<std::uint64_t>& sides,
                       std::uint64_t type = type_float)
{
    std::string shape;
    for (const auto side : sides)
        shape += part(1, number(1, side));
    return part(1, name) + part(2, part(1, number(1, type) + part(2, shape)));
}

std::string node(const std::string& operation, const std::vector<std::string>& inputs, const std::string& output)
{
    std::string bytes;
    for (const auto& input : inputs)
        bytes += part(1, input);
    return bytes + part(2, output) + part(3, operation + "_" + output) + part(4, operation);
}

constexpr int attribute_is_integer = 2;

std::string attribute(const std::string& name, std::uint64_t value)
{
    return part(5, part(1, name) + number(3, value) + number(20, attribute_is_integer));
}

}  // namespace

namespace {

template <class Number>
std::vector<std::uint64_t> sides_of(const std::vector<Number>& shape)
{
    return {shape.begin(), shape.end()};
}

/// The nodes and weights that make `shape` of a row of numbers.
std::string output(const std::string& row, const std::string& name, const std::vector<int>& shape,
                   const std::vector<float>& constants, const std::vector<float>& weights)
{
    const std::vector<std::int64_t> sides(shape.begin(), shape.end());
    const std::string own_weights = name + "_weights", own_constants = name + "_constants", numbers = name + "_numbers",
                      own_shape = name + "_shape";
    return part(1, node("Gemm", {row, own_weights, own_constants}, numbers) + attribute("transB", 1))
           + part(1, node("Reshape", {numbers, own_shape}, name))
           + part(5,
                  tensor(own_weights, type_float, {constants.size(), weights.size() / constants.size()}, raw(weights)))
           + part(5, tensor(own_constants, type_float, {constants.size()}, raw(constants)))
           + part(5, tensor(own_shape, type_int64, {sides.size()}, raw(sides)));
}

std::string cast(const std::string& input, const std::string& result, std::uint64_t type)
{
    return part(1, node("Cast", {input}, result) + attribute("to", type));
}

/// Multiplies rows x, y, x, y by the second input.
std::string multiplied(const std::string& shares, const std::string& name)
{
    return part(11, value_info("orig_target_sizes", {1, 2}, type_int64)) + cast("orig_target_sizes", "size", type_float)
           + part(1, node("Concat", {"size", "size"}, "corners") + attribute("axis", 1))
           + part(1, node("Mul", {shares, "corners"}, name));
}

}  // namespace

std::string bytes_of(const Model& model)
{
    const std::size_t inputs = static_cast<std::size_t>(3 * model.width * model.height);
    std::vector<float> weights(inputs * model.constants.size(), 0.0F);
    for (const Wire& wire : model.wires)
        weights[static_cast<std::size_t>(wire.to) * inputs + static_cast<std::size_t>(wire.from)] = wire.factor;
    const std::vector<std::uint64_t> input_sides{1, 3, static_cast<std::uint64_t>(model.height),
                                                 static_cast<std::uint64_t>(model.width)};
    const std::string row = model.operation.empty() ? "row" : "changed";
    std::string graph =
        part(1, node("Flatten", {"image"}, "row")) + part(2, "tiny") + part(11, value_info("image", input_sides))
        + output(row, model.sized ? "shares" : "objects", model.shape, model.constants, weights)
        + (model.sized ? multiplied("shares", "objects") : "") + part(12, value_info("objects", sides_of(model.shape)));
    if (!model.operation.empty())
        graph += part(1, node(model.operation, {"row"}, row));
    if (!model.more.empty())  // from the three means of the input: that needs few weights
        graph += part(1, node("GlobalAveragePool", {"image"}, "mean")) + part(1, node("Flatten", {"mean"}, "means"));
    for (const Model::Output& other : model.more)
        graph += output("means", other.integers ? other.name + "_floats" : other.name, other.shape, other.constants,
                        std::vector<float>(3 * other.constants.size(), 0.0F))
                 + (other.integers ? cast(other.name + "_floats", other.name, type_int64) : "")
                 + part(12, value_info(other.name, sides_of(other.shape), other.integers ? type_int64 : type_float));
    std::string metadata;
    for (const auto& [key, value] : model.metadata)
        metadata += part(14, part(1, key) + part(2, value));
    return number(1, 7) + part(7, graph) + part(8, part(1, "") + number(2, 11)) + metadata;
}

File::File(const std::string& suffix, const std::string& contents)
{
    std::string pattern = (std::filesystem::temp_directory_path() / ("hive-test-XXXXXX" + suffix)).string();
    const int descriptor = ::mkstemps(pattern.data(), static_cast<int>(suffix.size()));
    if (descriptor < 0)
        throw std::runtime_error("no temporary file");
    ::close(descriptor);
    path_ = pattern;
    std::ofstream(path_, std::ios::binary) << contents;
}

File::~File()
{
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

}  // namespace onnx
