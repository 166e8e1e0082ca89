#include "training/mattes/matte_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"

namespace neuvv::training {

namespace {

constexpr float kMostBeyond = 0.1f;  // by which an alpha may be below 0 or above 1 and still be one
// Pixels along the longer side of what a network sees at first that reduces images itself: Robust Video Matting's
// authors advise 0.4 for whole bodies in images of 1920 × 1080.
constexpr double kReducedSide = 768;

media::ImageSize size_of(const media::Image& image) {
    return {image.width, image.height};
}

// Means of pixels where it shrinks.
cv::Mat resized(const cv::Mat& image, media::ImageSize size) {
    const cv::Size wanted(static_cast<int>(size.width), static_cast<int>(size.height));
    cv::Mat made;
    const bool shrinks = wanted.width < image.cols || wanted.height < image.rows;
    cv::resize(image, made, wanted, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
    return made;
}

float sigmoid(float logit) {
    return 1 / (1 + std::exp(-logit));
}

}  // namespace

MatteNetwork::MatteNetwork(const std::filesystem::path& file) : MatteNetwork(motion::read_onnx_file(file)) {}

MatteNetwork::MatteNetwork(const motion::OnnxFile& onnx)
    : file_(onnx.name), model_(find_matte_model(onnx)), network_(onnx) {}

// What the network sees of an image, whose own alpha is ignored.
motion::Tensor MatteNetwork::seen(const media::Image& image) const {
    const media::ImageSize size = model_.seen_size(size_of(image));
    const cv::Mat whole(static_cast<int>(image.height), static_cast<int>(image.width), CV_8UC4,
                        const_cast<uint8_t*>(image.rgba.data()));
    const cv::Mat small = resized(whole, size);
    const size_t plane = size_t{size.width} * size.height;
    motion::Tensor tensor{{1, 3, small.rows, small.cols}, std::vector<float>(3 * plane)};
    const MatteFamily& family = *model_.family;
    for (size_t i = 0; i < plane; ++i) {
        const auto& rgba = small.at<cv::Vec4b>(static_cast<int>(i / size.width), static_cast<int>(i % size.width));
        for (size_t c = 0; c < 3; ++c) {
            const auto colour = static_cast<float>(rgba[family.channels[c]]) / 255;
            tensor.values[c * plane + i] = (colour - family.mean[c]) / family.deviation[c];
        }
    }
    return tensor;
}

// Zeros: a single one along sizes that are left open, which spreads over whatever the network adds it to.
motion::Tensor MatteNetwork::first_state(const motion::OnnxValue& input) const {
    motion::Tensor state;
    size_t count = 1;
    for (const uint64_t size : input.sizes) {
        state.sizes.push_back(static_cast<int>(std::max<uint64_t>(size, 1)));
        count *= std::max<uint64_t>(size, 1);
    }
    state.values.resize(count);
    return state;
}

std::vector<uint8_t> MatteNetwork::alpha_bytes(motion::Tensor alpha, media::ImageSize seen, media::ImageSize image,
                                               const std::string& name) const {
    const size_t count = size_t{seen.width} * seen.height, dimensions = alpha.sizes.size();
    if (dimensions < 2 || alpha.values.size() != count || alpha.sizes[dimensions - 1] != static_cast<int>(seen.width))
        throw InputError(
            file_, model_.alpha,
            fmt::format("is {}, not 1×1×{}×{} as the image that it is of", alpha.size_text(), seen.height, seen.width),
            "use a network whose alpha has the size of its image");
    // An export of a family that gives logits may have the sigmoid in it.
    const bool has_logits = model_.family->gives_logits && std::ranges::any_of(alpha.values, [](float value) {
                                return value < -kMostBeyond || value > 1 + kMostBeyond;
                            });
    for (float& value : alpha.values) {
        if (has_logits) value = sigmoid(value);
        if (!(value >= -kMostBeyond && value <= 1 + kMostBeyond))
            throw InputError(file_, model_.alpha, fmt::format("is {}, not from 0 to 1, for {}", value, name),
                             "export the model with its last sigmoid, or in single precision");
    }
    const cv::Mat small(static_cast<int>(seen.height), static_cast<int>(seen.width), CV_32F, alpha.values.data());
    const cv::Mat whole = resized(small, image);
    std::vector<uint8_t> bytes(whole.total());
    for (size_t i = 0; i < bytes.size(); ++i) {
        const float value = whole.at<float>(static_cast<int>(i / image.width), static_cast<int>(i % image.width));
        bytes[i] = static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f)));
    }
    return bytes;
}

std::vector<uint8_t> MatteNetwork::matte_of(const media::Image& image, const media::Image& plate, Memory& memory,
                                            const std::string& name) {
    const MatteFamily& family = *model_.family;
    std::map<std::string, motion::Tensor> inputs = std::move(memory);
    memory.clear();
    if (inputs.empty())
        for (const motion::OnnxValue& state : model_.states) inputs[state.name] = first_state(state);
    inputs[model_.image] = seen(image);
    if (wants_plate()) {
        assert(size_of(plate) == size_of(image) && "a plate of the image's size");
        inputs[family.plate] = seen(plate);
    }
    const media::ImageSize size = model_.seen_size(size_of(image));
    if (model_.has_ratio) {
        const double ratio = std::min(1.0, kReducedSide / std::max(size.width, size.height));
        inputs[family.ratio] = {{1}, {static_cast<float>(ratio)}};
    }
    std::vector<std::string> outputs{model_.alpha};
    for (const auto& state : family.states) outputs.push_back(state.second);
    std::vector<motion::Tensor> found = network_.run(inputs, outputs);
    for (size_t i = 0; i < family.states.size(); ++i) memory[family.states[i].first] = std::move(found[i + 1]);
    return alpha_bytes(std::move(found[0]), size, size_of(image), name);
}

}  // namespace neuvv::training
