// What an ONNX file says about the image that it wants, read without the library that runs it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace neuvv::motion {

struct OnnxInput {
    uint32_t width = 0, height = 0;  // pixels, 32 to 2048 each
};

// The size of the model's one input, 1×3×height×width. The batch may be left open. Throws InputError for bytes that are
// no whole ONNX model, for weights that are fewer than their sizes say, for several inputs, and for another shape.
// `file` is for errors.
OnnxInput read_onnx_input(std::span<const uint8_t> bytes, const std::string& file);

}  // namespace neuvv::motion
