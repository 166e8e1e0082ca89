// Networks of ONNX files, which the tests write, by the names of their inputs and outputs.
#include "motion/network/network.h"

#include <gtest/gtest.h>

#include "support/input_error.h"
#include "support/onnx_bytes.h"

namespace neuvv {
namespace {

using motion::Tensor;
using test::onnx_node, test::onnx_value;

const std::vector<uint64_t> kSizes{1, 1, 2, 3};

motion::OnnxFile parsed(const std::string& bytes) {
    return motion::parse_onnx({bytes.begin(), bytes.end()}, "a.onnx");
}

// sum = seen + memory, kept = sum + seen, doubled = kept + kept: `kept` is an output that another node reads, too.
std::string adding_network(const std::vector<uint64_t>& sizes) {
    test::ProtoMessage graph;
    graph.message(1, onnx_node("Add", {"seen", "memory"}, "sum", {}))
        .message(1, onnx_node("Add", {"sum", "seen"}, "kept", {}))
        .message(1, onnx_node("Add", {"kept", "kept"}, "doubled", {}))
        .text(2, "adding");
    for (const char* input : {"memory", "seen"}) graph.message(11, onnx_value(input, sizes));
    for (const char* output : {"doubled", "kept"}) graph.message(12, onnx_value(output, sizes));
    return test::onnx_bytes(graph);
}

TEST(Network, GivesWhatIsAskedForByName) {
    const motion::OnnxFile onnx = parsed(adding_network(kSizes));
    ASSERT_EQ(onnx.inputs.size(), 2u);
    EXPECT_EQ(onnx.inputs[1].name, "seen");
    EXPECT_EQ(onnx.inputs[1].size_text(), "1×1×2×3");
    ASSERT_EQ(onnx.outputs.size(), 2u);
    EXPECT_EQ(onnx.outputs[1].name, "kept");
    motion::Network network(onnx);
    Tensor memory{{1, 1, 2, 3}, std::vector<float>(6)};
    for (int run = 1; run < 4; ++run) {  // each run has other values
        const Tensor seen{{1, 1, 2, 3}, {1, 2, 3, 4, 5, 6}};
        const std::vector<Tensor> found = network.run({{"seen", seen}, {"memory", memory}}, {"kept", "doubled"});
        ASSERT_EQ(found.size(), 2u);
        EXPECT_EQ(found[0].sizes, (std::vector<int>{1, 1, 2, 3}));
        for (size_t i = 0; i < 6; ++i) {
            EXPECT_EQ(found[0].values[i], 2 * static_cast<float>(run) * seen.values[i]);
            EXPECT_EQ(found[1].values[i], 2 * found[0].values[i]);
        }
        memory = found[0];
    }
}

TEST(Network, RefusesWhatItCannotRun) {
    motion::Network network(parsed(adding_network(kSizes)));
    const Tensor right{{1, 1, 2, 3}, std::vector<float>(6)}, wrong{{1, 1, 4, 3}, std::vector<float>(12)};
    expect_input_error([&] { network.run({{"seen", right}, {"memory", wrong}}, {"kept"}); }, {"a.onnx", "OpenCV"});
    expect_input_error([&] { network.run({{"seen", right}, {"memory", right}}, {"none"}); }, {"a.onnx", "OpenCV"});
    EXPECT_EQ(network.run({{"seen", right}, {"memory", right}}, {"kept"})[0].values, right.values);
    expect_input_error([&] { parsed(adding_network({1, 3, 1 << 15, 1 << 15})); }, {"a.onnx", "memory", "larger"});
    expect_input_error([&] { parsed(adding_network({1, 3, uint64_t{1} << 62, 4})); }, {"a.onnx", "larger"});
    EXPECT_EQ(parsed(adding_network({0, 3, 0, uint64_t(-1)})).inputs[0].size_text(), "0×3×0×0");
}

}  // namespace
}  // namespace neuvv
