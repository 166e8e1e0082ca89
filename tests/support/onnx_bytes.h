// ONNX files as tests write them: protobuf messages by the members' numbers in onnx.proto.
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace neuvv::test {

// A protobuf message as it is written.
struct ProtoMessage {
    std::string bytes;

    ProtoMessage& number(uint64_t member, uint64_t value) {
        varint(member << 3);
        varint(value);
        return *this;
    }
    ProtoMessage& text(uint64_t member, const std::string& value) {
        varint(member << 3 | 2);
        varint(value.size());
        bytes += value;
        return *this;
    }
    ProtoMessage& message(uint64_t member, const ProtoMessage& value) { return text(member, value.bytes); }

  private:
    void varint(uint64_t value) {
        for (; value >= 0x80; value >>= 7) bytes += static_cast<char>(value | 0x80);
        bytes += static_cast<char>(value);
    }
};

// Weights.
inline ProtoMessage onnx_tensor(const std::string& name, std::span<const uint64_t> sizes,
                                const std::vector<float>& values) {
    ProtoMessage tensor;
    for (const uint64_t size : sizes) tensor.number(1, size);
    std::string raw;
    for (const float value : values)
        for (unsigned i = 0; i < 4; ++i) raw += static_cast<char>(std::bit_cast<uint32_t>(value) >> (8 * i));
    return tensor.number(2, 1).text(8, name).text(9, raw);
}

// An input or an output. A size of 0 is left open.
inline ProtoMessage onnx_value(const std::string& name, std::span<const uint64_t> sizes) {
    ProtoMessage shape;
    for (const uint64_t size : sizes)
        shape.message(1, size > 0 ? ProtoMessage().number(1, size) : ProtoMessage().text(2, "open"));
    const ProtoMessage type = ProtoMessage().number(1, 1).message(2, shape);
    return ProtoMessage().text(1, name).message(2, ProtoMessage().message(1, type));
}

// An attribute that is a list of whole numbers.
inline ProtoMessage onnx_integers(const std::string& name, std::span<const uint64_t> values) {
    ProtoMessage attribute;
    attribute.text(1, name);
    for (const uint64_t value : values) attribute.number(8, value);
    return attribute.number(20, 7);
}

// An attribute that is one whole number.
inline ProtoMessage onnx_integer(const std::string& name, uint64_t value) {
    return ProtoMessage().text(1, name).number(3, value).number(20, 2);
}

inline ProtoMessage onnx_node(const std::string& operation, const std::vector<std::string>& inputs,
                              const std::string& output, const std::vector<ProtoMessage>& attributes) {
    ProtoMessage node;
    for (const std::string& input : inputs) node.text(1, input);
    node.text(2, output).text(3, "make_" + output).text(4, operation);
    for (const ProtoMessage& attribute : attributes) node.message(5, attribute);
    return node;
}

// The bytes of an .onnx file of opset 11, with a graph of nodes (member 1), weights (5), inputs (11) and outputs (12).
inline std::string onnx_bytes(const ProtoMessage& graph) {
    return ProtoMessage().number(1, 7).message(7, graph).message(8, ProtoMessage().text(1, "").number(2, 11)).bytes;
}

}  // namespace neuvv::test
