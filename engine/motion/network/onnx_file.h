// A network in an ONNX file: its bytes, and what it says about its inputs and outputs, read without the library that
// runs it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace neuvv::motion {

// An input or an output.
struct OnnxValue {
    std::string name;
    std::vector<uint64_t> sizes;  // 0: left open. Of an input, together at most kMaxInputElements

    std::string size_text() const;  // "1×3×0×0"
};

constexpr uint64_t kMaxInputElements = uint64_t{1} << 28;  // an image of 9459 × 9459 pixels, or 1 GB

struct OnnxFile {
    std::string name;  // of the file, for errors
    std::vector<uint8_t> bytes;
    std::vector<OnnxValue> inputs, outputs;  // inputs that have weights in the file are left out
};

// Throws InputError for files that are missing, no whole ONNX model, have weights that are fewer than their sizes say,
// or inputs larger than any image.
OnnxFile read_onnx_file(const std::filesystem::path& path);
// The same for bytes in memory; `name` stands for the file in errors.
OnnxFile parse_onnx(std::vector<uint8_t> bytes, const std::string& name);

}  // namespace neuvv::motion
