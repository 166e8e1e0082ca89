// Small networks of mattes in ONNX files. Red is the performer: alpha is weight · red + bias, where red is what the
// network sees of it.
#pragma once

#include "support/onnx_bytes.h"

namespace neuvv::test {

struct RedNetwork {
    std::vector<uint64_t> size = {1, 3, 96, 96};  // of the image
    std::string image = "picture", alpha = "opacity";
    float weight = 1, bias = 0;
    std::string last_operation = {};  // on the alpha: AveragePool halves its size, Log makes NaN of what is below 0
    std::string plate = {};           // the input of a plate, less which the image counts
};

// Adds what makes the network's `alpha` of `input`, of the network's size.
inline void add_red(ProtoMessage& graph, const RedNetwork& network, const std::string& input,
                    const std::string& output) {
    const std::vector<uint64_t> point{1, 1};
    graph.message(1, onnx_node("Conv", {input, "weights", "bias"}, output, {onnx_integers("kernel_shape", point)}))
        .message(5, onnx_tensor("weights", std::vector<uint64_t>{1, 3, 1, 1}, {network.weight, 0, 0}))
        .message(5, onnx_tensor("bias", std::vector<uint64_t>{1}, {network.bias}));
}

inline std::string onnx_of(const RedNetwork& network) {
    ProtoMessage graph;
    graph.text(2, "red");
    const std::vector<uint64_t> two{2, 2};
    const std::string& last = network.last_operation;
    std::string seen = network.image;
    if (!network.plate.empty()) {
        graph.message(1, onnx_node("Sub", {network.image, network.plate}, "difference", {}));
        seen = "difference";
    }
    add_red(graph, network, seen, last.empty() ? network.alpha : "red");
    if (last == "AveragePool")
        graph.message(1, onnx_node(last, {"red"}, network.alpha,
                                   {onnx_integers("kernel_shape", two), onnx_integers("strides", two)}));
    else if (!last.empty())
        graph.message(1, onnx_node(last, {"red"}, network.alpha, {}));
    graph.message(11, onnx_value(network.image, network.size));
    if (!network.plate.empty()) graph.message(11, onnx_value(network.plate, network.size));
    const uint64_t smaller = last == "AveragePool" ? 2 : 1;
    graph.message(12, onnx_value(network.alpha,
                                 std::vector<uint64_t>{1, 1, network.size[2] / smaller, network.size[3] / smaller}));
    return onnx_bytes(graph);
}

// A network with the inputs and outputs of Robust Video Matting, which shows the alpha of the frame before: of the
// first frame that it sees, nothing. `open`: sizes are left open, as in the published file, and there is a ratio.
inline std::string late_network(const RedNetwork& network, bool open) {
    ProtoMessage graph;
    graph.text(2, "late");
    const std::vector<uint64_t> one{1, 1, 1, 1}, alpha{1, 1, network.size[2], network.size[3]};
    add_red(graph, network, "src", "r1o");
    graph.message(1, onnx_node("Sub", {"r1o", "r1o"}, "zero", {}))
        .message(1, onnx_node("Add", {"zero", "r1i"}, "pha", {}));
    const std::vector<uint64_t> any{0, 0, 0, 0};
    graph.message(11, onnx_value("src", open ? std::vector<uint64_t>{0, 3, 0, 0} : network.size))
        .message(11, onnx_value("r1i", open ? any : alpha));
    graph.message(12, onnx_value("pha", alpha)).message(12, onnx_value("r1o", alpha));
    for (const std::string& state : {std::string("r2"), std::string("r3"), std::string("r4")}) {
        graph.message(1, onnx_node("Add", {state + "i", state + "i"}, state + "o", {}));
        graph.message(11, onnx_value(state + "i", open ? any : one)).message(12, onnx_value(state + "o", one));
    }
    if (open) graph.message(11, onnx_value("downsample_ratio", std::vector<uint64_t>{1}));
    return onnx_bytes(graph);
}

}  // namespace neuvv::test
