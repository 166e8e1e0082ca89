#include "motion/colour_model.h"

#include <algorithm>
#include <cmath>

#include "support/onnx_bytes.h"

namespace neuvv::test {

namespace {

constexpr double kGreyLevel = 124, kReach = 100;  // of 255

// Adds a node that keeps the greatest values along an axis.
void add_greatest(ProtoMessage& graph, const std::string& input, const std::string& output, uint64_t axis) {
    graph.message(1, onnx_node("ReduceMax", {input}, output,
                               {onnx_integers("axes", std::vector{axis}), onnx_integer("keepdims", 0)}));
}

// Directions of colours, evenly over the sphere.
glm::dvec3 direction(size_t key_point, size_t key_points) {
    const double z = 1 - (2.0 * double(key_point) + 1) / double(key_points), turn = 2.399963 * double(key_point);
    const double radius = std::sqrt(1 - z * z);
    return {radius * std::cos(turn), radius * std::sin(turn), z};
}

// value = scale · colour + shift, for each channel.
struct Scaling {
    glm::dvec3 scale{1}, shift{0};
};
Scaling scaling_of(motion::PixelScale scale) {
    if (scale == motion::PixelScale::kBytes) return {};
    if (scale == motion::PixelScale::kUnit) return {glm::dvec3(1 / 255.0), {}};
    const glm::dvec3 mean(0.485, 0.456, 0.406), deviation(0.229, 0.224, 0.225);
    return {1.0 / (255.0 * deviation), -mean / deviation};
}

}  // namespace

std::string onnx_of(const ColourModel& model) {
    const auto [scale, shift] = scaling_of(model.scale);
    std::vector<float> weights, biases;
    for (size_t k = 0; k < model.key_points; ++k) {
        const glm::dvec3 weight = direction(k, model.key_points) / kReach / scale;
        for (int c = 0; c < 3; ++c) weights.push_back(static_cast<float>(weight[c]));
        biases.push_back(static_cast<float>(-glm::dot(weight, kGreyLevel * scale + shift)));
    }
    const std::string maps = model.simcc ? "maps" : "output";
    ProtoMessage graph;
    graph.message(1, onnx_node(model.first_operation, {"image", "weights", "biases"}, model.pool > 1 ? "fine" : maps,
                               {onnx_integers("kernel_shape", std::vector<uint64_t>{1, 1})}));
    if (model.pool > 1)
        graph.message(1, onnx_node("AveragePool", {"fine"}, maps,
                                   {onnx_integers("kernel_shape", std::vector{model.pool, model.pool}),
                                    onnx_integers("strides", std::vector{model.pool, model.pool})}));
    if (model.simcc && !model.columns_last) add_greatest(graph, maps, "simcc_x", 2);
    if (model.simcc) add_greatest(graph, maps, "simcc_y", 3);
    if (model.simcc && model.columns_last) add_greatest(graph, maps, "simcc_x", 2);
    graph.text(2, "colours")
        .message(5, onnx_tensor("weights", std::vector<uint64_t>{model.key_points, 3, 1, 1}, weights))
        .message(5, onnx_tensor("biases", std::vector<uint64_t>{model.key_points}, biases))
        .message(11, onnx_value("image", model.input));
    const uint64_t height = model.input[2] / model.pool, width = model.input.back() / model.pool;
    if (model.simcc) {
        graph.message(12, onnx_value("simcc_x", std::vector<uint64_t>{1, model.key_points, width}));
        graph.message(12, onnx_value("simcc_y", std::vector<uint64_t>{1, model.key_points, height}));
    } else {
        graph.message(12, onnx_value("output", std::vector<uint64_t>{1, model.key_points, height, width}));
    }
    return onnx_bytes(graph);
}

void draw_marker(media::Image& image, size_t key_point, size_t key_points, const glm::dvec2& centre, double deviation) {
    const glm::dvec3 colour = kReach * direction(key_point, key_points);
    const glm::dvec2 last(image.width, image.height);
    const glm::uvec2 low = glm::max(centre - 4 * deviation, 0.0), high = glm::min(centre + 4 * deviation, last);
    for (uint32_t y = low.y; y < high.y; ++y)
        for (uint32_t x = low.x; x < high.x; ++x) {
            const double off = glm::distance(centre, {x + 0.5, y + 0.5}) / deviation;
            for (int c = 0; c < 3; ++c) {
                uint8_t& value = image.at(x, y)[c];
                const double marked = value + colour[c] * std::exp(-0.5 * off * off);
                value = static_cast<uint8_t>(std::clamp(std::lround(marked), 0l, 255l));
            }
        }
}

media::Image grey_image(uint32_t width, uint32_t height) {
    media::Image image(width, height);
    std::ranges::fill(image.rgba, static_cast<uint8_t>(kGreyLevel));
    for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
    return image;
}

}  // namespace neuvv::test
