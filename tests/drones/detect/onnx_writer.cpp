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

std::string value_info(const std::string& name, const std::vector<std::uint64_t>& sides)
{
    std::string shape;
    for (const auto side : sides)
        shape += part(1, number(1, side));
    return part(1, name) + part(2, part(1, number(1, type_float) + part(2, shape)));
}

std::string node(const std::string& operation, const std::vector<std::string>& inputs, const std::string& output)
{
    std::string bytes;
    for (const auto& input : inputs)
        bytes += part(1, input);
    return bytes + part(2, output) + part(3, operation) + part(4, operation);
}

constexpr int attribute_is_integer = 2;

std::string attribute(const std::string& name, std::uint64_t value)
{
    return part(5, part(1, name) + number(3, value) + number(20, attribute_is_integer));
}

}  // namespace

std::string bytes_of(const Model& model)
{
    const std::size_t inputs = static_cast<std::size_t>(3 * model.width * model.height),
                      outputs = model.constants.size();
    std::vector<float> weights(inputs * outputs, 0.0F);
    for (const Wire& wire : model.wires)
        weights[static_cast<std::size_t>(wire.to) * inputs + static_cast<std::size_t>(wire.from)] = wire.factor;
    const std::vector<std::int64_t> shape(model.shape.begin(), model.shape.end());
    const std::vector<std::uint64_t> sides(model.shape.begin(), model.shape.end());
    const std::vector<std::uint64_t> input_sides{1, 3, static_cast<std::uint64_t>(model.height),
                                                 static_cast<std::uint64_t>(model.width)};
    const std::string graph =
        part(1, node("Flatten", {"image"}, "row"))
        + part(1, node("Gemm", {"row", "weights", "constants"}, "numbers") + attribute("transB", 1))
        + part(1, node("Reshape", {"numbers", "shape"}, "objects")) + part(2, "tiny")
        + part(5, tensor("weights", type_float, {outputs, inputs}, raw(weights)))
        + part(5, tensor("constants", type_float, {outputs}, raw(model.constants)))
        + part(5, tensor("shape", type_int64, {shape.size()}, raw(shape))) + part(11, value_info("image", input_sides))
        + part(12, value_info("objects", sides));
    return number(1, 7) + part(7, graph) + part(8, part(1, "") + number(2, 11));
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
