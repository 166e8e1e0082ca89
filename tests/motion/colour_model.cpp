#include "motion/colour_model.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace neuvv::test {

namespace {

constexpr double kGreyLevel = 124, kReach = 100;  // of 255

// A protobuf message as it is written.
struct Message {
    std::string bytes;

    Message& number(uint64_t member, uint64_t value) {
        varint(member << 3);
        varint(value);
        return *this;
    }
    Message& text(uint64_t member, const std::string& value) {
        varint(member << 3 | 2);
        varint(value.size());
        bytes += value;
        return *this;
    }
    Message& message(uint64_t member, const Message& value) { return text(member, value.bytes); }

  private:
    void varint(uint64_t value) {
        for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
        bytes += static_cast<char>(value);
    }
};

Message tensor(const std::string& name, std::span<const uint64_t> sizes, const std::vector<float>& values) {
    Message tensor;
    for (const uint64_t size : sizes) tensor.number(1, size);
    std::string raw;
    for (const float value : values)
        for (unsigned i = 0; i < 4; ++i) raw += static_cast<char>(std::bit_cast<uint32_t>(value) >> (8 * i));
    return tensor.number(2, 1).text(8, name).text(9, raw);
}

// A size of 0 is left open.
Message value_info(const std::string& name, std::span<const uint64_t> sizes) {
    Message shape;
    for (const uint64_t size : sizes)
        shape.message(1, size > 0 ? Message().number(1, size) : Message().text(2, "batch"));
    const Message type = Message().number(1, 1).message(2, shape);
    return Message().text(1, name).message(2, Message().message(1, type));
}

Message integers(const std::string& name, std::span<const uint64_t> values) {
    Message attribute;
    attribute.text(1, name);
    for (const uint64_t value : values) attribute.number(8, value);
    return attribute.number(20, 7);
}

Message node(const std::string& operation, const std::vector<std::string>& inputs, const std::string& output,
             const std::vector<Message>& attributes) {
    Message node;
    for (const std::string& input : inputs) node.text(1, input);
    node.text(2, output).text(3, "make_" + output).text(4, operation);
    for (const Message& attribute : attributes) node.message(5, attribute);
    return node;
}

// Adds a node that keeps the greatest values along an axis.
void add_greatest(Message& graph, const std::string& input, const std::string& output, uint64_t axis) {
    const Message keep = Message().text(1, "keepdims").number(3, 0).number(20, 2);
    graph.message(1, node("ReduceMax", {input}, output, {integers("axes", std::vector{axis}), keep}));
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
    Message graph;
    graph.message(1, node(model.first_operation, {"image", "weights", "biases"}, model.pool > 1 ? "fine" : maps,
                          {integers("kernel_shape", std::vector<uint64_t>{1, 1})}));
    if (model.pool > 1)
        graph.message(1, node("AveragePool", {"fine"}, maps,
                              {integers("kernel_shape", std::vector{model.pool, model.pool}),
                               integers("strides", std::vector{model.pool, model.pool})}));
    if (model.simcc && !model.columns_last) add_greatest(graph, maps, "simcc_x", 2);
    if (model.simcc) add_greatest(graph, maps, "simcc_y", 3);
    if (model.simcc && model.columns_last) add_greatest(graph, maps, "simcc_x", 2);
    graph.text(2, "colours")
        .message(5, tensor("weights", std::vector<uint64_t>{model.key_points, 3, 1, 1}, weights))
        .message(5, tensor("biases", std::vector<uint64_t>{model.key_points}, biases))
        .message(11, value_info("image", model.input));
    const uint64_t height = model.input[2] / model.pool, width = model.input.back() / model.pool;
    if (model.simcc) {
        graph.message(12, value_info("simcc_x", std::vector<uint64_t>{1, model.key_points, width}));
        graph.message(12, value_info("simcc_y", std::vector<uint64_t>{1, model.key_points, height}));
    } else {
        graph.message(12, value_info("output", std::vector<uint64_t>{1, model.key_points, height, width}));
    }
    return Message().number(1, 7).message(7, graph).message(8, Message().text(1, "").number(2, 11)).bytes;
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
