// What an ONNX file says of its model: within its limits, whatever the file is. Input: the bytes of the file.
#include "memory_file.hpp"
#include "onnx_file.hpp"
#include "require.hpp"

#include <cstdint>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size)
{
    using hive::fuzz::require;
    const std::string file(reinterpret_cast<const char*>(bytes), size);
    const hive::fuzz::MemoryFile memory(file);
    const auto card = detect::model_card(memory.path());
    require(card.input.width >= 0 && card.input.width <= 4096, "a width is possible");
    require(card.input.height >= 0 && card.input.height <= 4096, "a height is possible");
    require(card.names.size() <= 10'000, "there are not too many names");
    require(card.operators.size() <= 200, "nor too many operators");
    require(card.keypoints >= 0 && card.keypoints <= 1000, "a number of keypoints is possible");
    require(detect::names_from(file).size() <= 10'000, "nor in a text alone");
    return 0;
}
