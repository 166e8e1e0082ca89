#include "training/mattes/matte_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace neuvv::training {

namespace {

using motion::OnnxFile;
using motion::OnnxValue;

constexpr std::array<float, 3> kImageNetMean{0.485f, 0.456f, 0.406f}, kImageNetDeviation{0.229f, 0.224f, 0.225f};
constexpr std::array<float, 3> kMiddleGrey{0.5f, 0.5f, 0.5f};

// The first that fits counts: those that name their outputs come before those of the same size that do not.
const std::vector<MatteFamily> kFamilies = {
    {.name = "Robust Video Matting",
     .image = {"src"},
     .alpha = {"pha"},
     .ratio = "downsample_ratio",
     .states = {{"r1i", "r1o"}, {"r2i", "r2o"}, {"r3i", "r3o"}, {"r4i", "r4o"}}},
    {.name = "Background Matting V2", .image = {"src"}, .alpha = {"pha"}, .plate = "bgr", .multiple = 4},
    {.name = "BiRefNet",
     .image = {"input_image"},
     .alpha = {"output_image"},
     .size = SeenSize::kSquare,
     .side = 1024,
     .mean = kImageNetMean,
     .deviation = kImageNetDeviation,
     .gives_logits = true},
    {.name = "U²-Net",
     .image = {"input.1", "input", "image", "img"},
     .alpha = {},
     .size = SeenSize::kSquare,
     .side = 320,
     .mean = kImageNetMean,
     .deviation = kImageNetDeviation},
    {.name = "MODNet",
     .image = {"input"},
     .alpha = {"output"},
     .size = SeenSize::kShorter,
     .side = 512,
     .multiple = 32,
     .mean = kMiddleGrey,
     .deviation = kMiddleGrey},
    {.name = "IS-Net",
     .image = {"input", "input.1", "input_image", "image", "img"},
     .alpha = {},
     .size = SeenSize::kSquare,
     .side = 1024,
     .mean = kMiddleGrey},
};

// What is assumed of a network that nobody knows.
const MatteFamily kAnyFamily{
    .name = "any", .image = {}, .alpha = {}, .size = SeenSize::kLongest, .side = 1024, .multiple = 32};

// Whether a value has these sizes; 0 fits any, and any size fits one that is left open.
bool has_sizes(const OnnxValue& value, std::initializer_list<uint64_t> sizes) {
    return std::ranges::equal(value.sizes, sizes, [](uint64_t a, uint64_t b) { return a == b || a == 0 || b == 0; });
}

bool is_image(const OnnxValue& value) {
    return has_sizes(value, {1, 3, 0, 0}) && value.sizes[1] == 3 &&
           std::ranges::all_of(value.sizes, [](uint64_t size) { return size <= media::kMaxImageSide; });
}

const OnnxValue* find_value(const std::vector<OnnxValue>& values, const std::vector<std::string>& names) {
    const auto found =
        std::ranges::find_if(values, [&](const OnnxValue& v) { return std::ranges::count(names, v.name) > 0; });
    return found == values.end() ? nullptr : &*found;
}

// Fills in what the file has of the family. Returns false where it is another's.
bool is_of(const MatteFamily& family, const OnnxFile& onnx, MatteModel& model) {
    model = {.family = &family};
    const OnnxValue* image = family.image.empty() ? &onnx.inputs.front() : find_value(onnx.inputs, family.image);
    const OnnxValue* alpha = family.alpha.empty() ? &onnx.outputs.front() : find_value(onnx.outputs, family.alpha);
    if (!image || !alpha || !is_image(*image)) return false;
    model.image = image->name;
    model.alpha = alpha->name;
    model.height = static_cast<uint32_t>(image->sizes[2]);
    model.width = static_cast<uint32_t>(image->sizes[3]);
    if (family.size == SeenSize::kSquare && (model.width != family.side || model.height != family.side)) return false;
    size_t known = 1;
    if (model.wants_plate()) {
        const OnnxValue* plate = find_value(onnx.inputs, {family.plate});
        if (!plate || !is_image(*plate)) return false;
        ++known;
    }
    for (const auto& [input, output] : family.states) {
        const OnnxValue* state = find_value(onnx.inputs, {input});
        if (!state || state->sizes.empty() || !find_value(onnx.outputs, {output})) return false;
        model.states.push_back(*state);
        ++known;
    }
    model.has_ratio = !family.ratio.empty() && find_value(onnx.inputs, {family.ratio});
    return known + model.has_ratio == onnx.inputs.size();
}

// "src 1×3×0×0, bgr 1×3×0×0".
std::string text_of(const std::vector<OnnxValue>& values) {
    std::string text;
    for (const OnnxValue& value : values)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", value.name, value.size_text());
    return text.empty() ? "nothing" : text;
}

std::string family_names() {
    std::string names;
    for (const MatteFamily& family : kFamilies) names += (names.empty() ? "" : ", ") + family.name;
    return names;
}

uint32_t multiple_near(double pixels, uint32_t multiple) {
    return multiple * static_cast<uint32_t>(std::max(1.0, std::round(pixels / multiple)));
}

// By how much a family reduces or enlarges an image whose size its file leaves open.
double scale_of(const MatteFamily& family, media::ImageSize image) {
    const double shorter = std::min(image.width, image.height), longer = std::max(image.width, image.height);
    if (family.size == SeenSize::kShorter && (shorter > family.side || longer < family.side))
        return family.side / shorter;
    if (family.size == SeenSize::kLongest) return std::min(1.0, family.side / longer);
    return 1;
}

}  // namespace

media::ImageSize MatteModel::seen_size(media::ImageSize image_size) const {
    const double scale = scale_of(*family, image_size);
    return {width > 0 ? width : multiple_near(scale * image_size.width, family->multiple),
            height > 0 ? height : multiple_near(scale * image_size.height, family->multiple)};
}

MatteModel find_matte_model(const OnnxFile& onnx) {
    MatteModel model;
    if (!onnx.inputs.empty() && !onnx.outputs.empty()) {
        for (const MatteFamily& family : kFamilies)
            if (is_of(family, onnx, model)) {
                model.is_known = true;
                return model;
            }
        const OnnxValue& output = onnx.outputs.front();
        const bool is_alpha = has_sizes(output, {1, 1, 0, 0}) || has_sizes(output, {1, 0, 0});
        if (onnx.outputs.size() == 1 && is_alpha && is_of(kAnyFamily, onnx, model)) return model;
    }
    throw InputError(onnx.name, "graph.input",
                     fmt::format("takes {} and gives {} (0: left open), which no network of mattes does that is known",
                                 text_of(onnx.inputs), text_of(onnx.outputs)),
                     fmt::format("use one of {}, or one that takes an image, 1×3×height×width, and gives its alpha",
                                 family_names()));
}

std::string text_of(const MatteModel& model, const OnnxFile& onnx) {
    if (model.is_known) return fmt::format("{}: {}", onnx.name, model.family->name);
    return fmt::format("{}: no network that is known; it sees RGB of 0 to 1, and its {} is taken as alpha", onnx.name,
                       model.alpha);
}

}  // namespace neuvv::training
