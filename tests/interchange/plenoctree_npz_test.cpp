// Frames as PlenOctrees: what svox finds at points of the world, what our import reads, and what volrend's reader
// needs.
#include "interchange/volume/plenoctree_npz.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/formats/npy.h"
#include "base/formats/npz.h"
#include "media/image.h"
#include "support/n3_tree.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/half.h"
#include "voctree/files/plenoctree.h"
#include "voctree/sh_weights.h"
#include "voctree/tree_slice.h"

namespace neuvv {
namespace {

double sigmoid(double x) {
    return 1 / (1 + std::exp(-x));
}

template <typename T>
std::vector<T> numbers_of(const NpzReader& npz, const std::string& name, const std::string& type) {
    const std::vector<uint8_t> bytes = npz.bytes(name);
    const NpyHeader header = parse_npy_header(bytes, "tree.npz", name);
    EXPECT_EQ(header.type, type) << name;
    std::vector<T> numbers(header.count);
    if (!numbers.empty()) std::memcpy(numbers.data(), &bytes[header.begin], numbers.size() * sizeof(T));
    return numbers;
}

struct PlenoctreeNpz : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "tree.npz";
    slice::Slice volume;

    void write(uint32_t degree) {
        volume = voctree::slice_of(
            test::random_tree({.node_levels = 3, .leaves = 500, .bases = 2, .hh_degree = degree, .frames = 2}), 1);
        ASSERT_GT(volume.leaves.size(), 100u);
        // Colours that depend little on the direction, as those of trained clips do.
        for (slice::Leaf& leaf : volume.leaves)
            for (auto& channel : leaf.colours)
                for (size_t k = 1; k < channel.size(); ++k) channel[k] *= 0.2f;
        volume.leaves[7].sigma = 1e6f;  // more than a half holds
        interchange::write_plenoctree(file, volume);
    }
    test::N3Tree n3tree() const {
        const NpzReader npz(file);
        test::N3Tree tree;
        tree.functions = static_cast<uint32_t>((numbers_of<int64_t>(npz, "data_dim", "<i8").at(0) - 1) / 3);
        tree.child = numbers_of<int32_t>(npz, "child", "<i4");
        for (const uint16_t half : numbers_of<uint16_t>(npz, "data", "<f2"))
            tree.data.push_back(voctree::float_from_half(half));
        const auto offset = numbers_of<float>(npz, "offset", "<f4"),
                   scale = numbers_of<float>(npz, "invradius3", "<f4");
        tree.offset = {offset.at(0), offset.at(1), offset.at(2)};
        tree.invradius = {scale.at(0), scale.at(1), scale.at(2)};
        return tree;
    }
};

// The sRGB colour of a leaf of the volume in a direction.
double shown_colour(const slice::Leaf& leaf, size_t channel, uint32_t degree, glm::dvec3 d) {
    const auto basis = voctree::sh_basis(d);
    double logit = 0;
    for (size_t k = 0; k < sh_count(degree); ++k) logit += static_cast<double>(leaf.colours[channel][k]) * basis[k];
    return media::srgb_from_linear(sigmoid(logit));
}

TEST_F(PlenoctreeNpz, SvoxFindsEachLeafInItsPlace) {
    for (const uint32_t degree : {0u, 2u, 3u}) {
        write(degree);
        const test::N3Tree tree = n3tree();
        EXPECT_EQ(tree.functions, sh_count(degree));
        test::Random random(3);
        double worst = 0;
        for (const slice::Leaf& leaf : volume.leaves) {
            const glm::dvec3 at = glm::dvec3(volume.centre_m(leaf)) +
                                  0.4 * glm::dvec3(volume.edges_m(leaf)) *
                                      glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            double side = 0;
            const float* numbers = tree.query({at.x, -at.z, at.y}, &side);
            EXPECT_EQ(side, std::ldexp(1.0, -static_cast<int>(leaf.depth)));
            EXPECT_EQ(numbers[3 * tree.functions],
                      voctree::float_from_half(voctree::half_from_float(std::min(leaf.sigma, voctree::kMaxHalf))));
            const glm::dvec3 d =
                glm::normalize(glm::dvec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)) + 1e-6);
            const glm::dvec3 logits = tree.logits(numbers, {d.x, -d.z, d.y});
            for (size_t c = 0; c < 3; ++c)
                worst =
                    std::max(worst, std::abs(sigmoid(logits[static_cast<int>(c)]) - shown_colour(leaf, c, degree, d)));
        }
        EXPECT_LT(worst, degree == 0 ? 1e-3 : 0.03) << degree;
        // Empty space is empty.
        size_t dense = 0;
        for (size_t cell = 0; cell < tree.child.size(); ++cell)
            dense += tree.child[cell] == 0 && tree.data[cell * tree.numbers() + 3 * tree.functions] > 0;
        EXPECT_EQ(dense, volume.leaves.size());
    }
}

TEST_F(PlenoctreeNpz, OurImportReadsTheSameLeaves) {
    write(2);
    const voctree::VOctree tree = voctree::read_plenoctree(file, voctree::PlenoctreeColours::kAsStored);
    EXPECT_LT(glm::distance(tree.box_min, volume.box_min), 1e-5f);
    EXPECT_LT(glm::distance(tree.box_size, volume.box_size), 1e-5f);
    const slice::Slice read = voctree::slice_of(tree, 0);
    ASSERT_EQ(read.leaves.size(), volume.leaves.size());
    for (size_t i = 0; i < read.leaves.size(); ++i) {
        EXPECT_LT(glm::distance(read.centre_m(read.leaves[i]), volume.centre_m(volume.leaves[i])), 1e-5f) << i;
        EXPECT_EQ(read.leaves[i].depth, volume.leaves[i].depth);
    }
    // In linear light, the colours are the clip's again.
    const auto linear = voctree::slice_of(voctree::read_plenoctree(file), 0);
    double sum = 0;
    for (size_t i = 0; i < linear.leaves.size(); ++i)
        sum += std::abs(shown_colour(linear.leaves[i], 1, 2, {0.6, 0.8, 0}) -
                        shown_colour(volume.leaves[i], 1, 2, {0.6, 0.8, 0}));
    EXPECT_LT(sum / static_cast<double>(linear.leaves.size()), 0.003);
}

TEST_F(PlenoctreeNpz, FramesMayBeEmpty) {
    write(2);
    volume.leaves.clear();
    interchange::write_plenoctree(file, volume);
    const NpzReader npz(file);
    EXPECT_EQ(numbers_of<int32_t>(npz, "child", "<i4"), std::vector<int32_t>(8));
    EXPECT_EQ(numbers_of<uint16_t>(npz, "data", "<f2"), std::vector<uint16_t>(8 * 28));
}

// svox' load, and volrend's cnpy, which trusts the sizes in the local header of each array.
TEST_F(PlenoctreeNpz, HasWhatTheReadersOfSvoxAndVolrendTake) {
    write(2);
    const NpzReader npz(file);
    const auto child = numbers_of<int32_t>(npz, "child", "<i4");
    const auto parents = numbers_of<int32_t>(npz, "parent_depth", "<i4");
    const size_t nodes = child.size() / 8;
    ASSERT_EQ(parents.size(), 2 * nodes);
    EXPECT_EQ(numbers_of<int64_t>(npz, "n_internal", "<i8").at(0), static_cast<int64_t>(nodes));
    EXPECT_EQ(numbers_of<int64_t>(npz, "n_free", "<i8").at(0), 0);
    EXPECT_EQ(numbers_of<double>(npz, "geom_resize_fact", "<f8").at(0), 1);
    EXPECT_EQ(parse_npy_header(npz.bytes("data_format"), "tree.npz", "data_format").type, "<U3");
    const std::vector<uint8_t> format = npz.bytes("data_format");
    EXPECT_EQ(std::string(format.end() - 12, format.end()), std::string("S\0\0\0H\0\0\0009\0\0\0", 12));
    int32_t deepest = 0;
    for (size_t cell = 0; cell < child.size(); ++cell) {
        if (child[cell] == 0) continue;
        const auto below = static_cast<size_t>(static_cast<int64_t>(cell / 8) + child[cell]);
        EXPECT_EQ(parents[2 * below], static_cast<int32_t>(cell));
        EXPECT_EQ(parents[2 * below + 1], parents[2 * (cell / 8) + 1] + 1);
        deepest = std::max(deepest, parents[2 * below + 1]);
    }
    EXPECT_GT(numbers_of<int64_t>(npz, "depth_limit", "<i8").at(0), deepest);
    const std::string bytes = read_text(file);
    const auto number = [&](size_t at, size_t size) {
        uint64_t value = 0;
        std::memcpy(&value, &bytes[at], size);
        return value;
    };
    size_t at = 0, arrays = 0;
    while (bytes.compare(at, 4, "PK\x03\x04") == 0) {
        EXPECT_EQ(number(at + 6, 2) & 8, 0u) << "sizes come behind the data";
        at += 30 + number(at + 26, 2) + number(at + 28, 2) + number(at + 18, 4);
        ++arrays;
    }
    EXPECT_EQ(arrays, npz.names().size());
    EXPECT_EQ(bytes.compare(at, 4, "PK\x01\x02"), 0);
}

}  // namespace
}  // namespace neuvv
