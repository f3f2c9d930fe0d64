// Writes tiny ONNX models, so that reading models is tested with real ones that need no download.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace onnx {

/// Output number `to` gets `factor` times the value at the place `from` of the input, seen as one row.
struct Wire {
    int from, to;
    float factor;
};

/// A model with one input of 1x3x`height`x`width` floats and one output of `shape`: constants, plus what the wires
/// bring from the input. In ONNX: Flatten, Gemm, Reshape.
struct Model {
    int width = 8, height = 8;
    std::vector<int> shape;
    std::vector<float> constants;  ///< as many as the output has numbers
    std::vector<Wire> wires;
    /// Another output, of constants.
    struct Output {
        std::string name;
        std::vector<int> shape;
        std::vector<float> constants;
        bool integers = false;  ///< of 64 bits
    };
    std::vector<Output> more = {};
    std::vector<std::pair<std::string, std::string>> metadata = {};
    std::string operation = {};  ///< of a node of one input and output in between; empty: no node
    /// There is a second input, orig_target_sizes (width, height), by which the rows x, y, x, y of `shape` are
    /// multiplied.
    bool sized = false;
};

/// The bytes of the model in the format of ONNX (protocol buffers).
std::string bytes_of(const Model& model);

/// A file in the temporary directory that is gone with the object.
class File {
public:
    File(const std::string& suffix, const std::string& contents);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    [[nodiscard]] std::string path() const { return path_.string(); }

private:
    std::filesystem::path path_;
};

}  // namespace onnx
