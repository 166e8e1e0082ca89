// Which network of mattes an ONNX file has, and what it wants to see: known by the names of its inputs and outputs.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "media/image.h"
#include "motion/network/onnx_file.h"

namespace neuvv::training {

// To which size an image is brought where the file leaves the size open.
enum class SeenSize : uint8_t {
    kOwn,      // its own
    kSquare,   // MatteFamily::side × side, whatever its shape: files of such a family have this size
    kShorter,  // its shorter side is `side`, unless `side` is between its two sides
    kLongest,  // its longer side is at most `side`
};

// Networks that are used alike. Names are those that published files have.
struct MatteFamily {
    std::string name;
    std::vector<std::string> image;  // what the input of the image may be called; empty: anything
    std::vector<std::string> alpha;  // and the output of the alpha; empty: it is the first output
    std::string plate = {};          // the input of the clean plate; empty: the network sees none
    std::string ratio = {};          // the input of a number: by how much the network itself reduces the image first
    std::vector<std::pair<std::string, std::string>> states = {};  // input, and the output of the frame before
    SeenSize size = SeenSize::kOwn;
    uint32_t side = 0, multiple = 1;  // pixels; sides are multiples of the latter
    // The network sees (colour − mean) / deviation of colours of 0 to 1 in this order.
    std::array<float, 3> mean{0, 0, 0}, deviation{1, 1, 1};
    std::array<uint8_t, 3> channels{0, 1, 2};  // of R, G and B
    bool gives_logits = false;  // alpha is the sigmoid of what it gives, unless all of that is from 0 to 1
};

// A file of a family.
struct MatteModel {
    const MatteFamily* family = nullptr;
    bool is_known = false;                       // else the family is what is assumed of any network
    std::string image = {}, alpha = {};          // names
    bool has_ratio = false;                      // whether the ratio of the family is an input of this file
    uint32_t width = 0, height = 0;              // that the file fixes; 0: open
    std::vector<motion::OnnxValue> states = {};  // the inputs of the family's states

    bool wants_plate() const { return !family->plate.empty(); }
    // Of what the network sees of an image.
    media::ImageSize seen_size(media::ImageSize image_size) const;
};

// Throws InputError for a file that is none of the known families and has not one image, 1×3×height×width, as its only
// input and one alpha as its only output: with the inputs and outputs that it has, and the families.
MatteModel find_matte_model(const motion::OnnxFile& onnx);

// What somebody should know who sees the mattes: "u2net.onnx: U²-Net".
std::string text_of(const MatteModel& model, const motion::OnnxFile& onnx);

}  // namespace neuvv::training
