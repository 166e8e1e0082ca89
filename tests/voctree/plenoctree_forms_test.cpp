// Tests the forms in which PlenOctrees come: with +Z or +Y up, of old versions of svox, quantised, in NDC, with
// infinite densities.
#include <gtest/gtest.h>

#include <cmath>

#include "reference/sample.h"
#include "reference/slice.h"
#include "support/input_error.h"
#include "support/n3_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/clip.h"
#include "voctree/files/plenoctree.h"

namespace neuvv::test {
namespace {

using voctree::PlenoctreeColours, voctree::UpAxis;

struct PlenoctreeFormsTest : ::testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "tree.npz";

    voctree::VOctree read(const std::map<std::string, std::string>& arrays, UpAxis up = UpAxis::kY) {
        write_npz(file, arrays, ZIP_CM_DEFLATE);
        return voctree::read_plenoctree(file, PlenoctreeColours::kAsStored, up);
    }
};

// A point p and a direction d of the clip are (x, −z, y) in the file, as those of a transforms.json are turned to
// (x, z, −y).
TEST_F(PlenoctreeFormsTest, ATreeWithZUpIsTurnedWithItsColours) {
    uint64_t seed = 40;
    for (const uint32_t functions : {0u, 1u, 4u, 9u, 16u}) {
        SCOPED_TRACE(functions);
        const N3Tree truth = random_n3tree(functions, true, ++seed);
        const voctree::VOctree tree = read(truth.arrays(), UpAxis::kZ);
        ASSERT_EQ(voctree::defect_of(tree), "");
        const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
        Random random(seed);
        uint32_t seen = 0;
        for (int i = 0; i < 500; ++i) {
            const glm::dvec3 in_tree(random.uniform(), random.uniform(), random.uniform());
            const glm::dvec3 at = glm::dvec3(tree.box_min) + in_tree * glm::dvec3(tree.box_size);
            const float* expected = truth.query({at.x, -at.z, at.y});
            const uint32_t leaf = voctree::find_leaf(tree, in_tree);
            ASSERT_EQ(leaf != UINT32_MAX, expected[truth.numbers() - 1] > 0);
            if (leaf == UINT32_MAX) continue;
            ++seen;
            const glm::dvec3 d =
                glm::normalize(glm::dvec3(random.bell(), random.bell(), random.bell()) + glm::dvec3(1e-9));
            const glm::dvec3 logits = truth.logits(expected, {d.x, -d.z, d.y});
            const glm::dvec3 colour = reference::sample_colour(slices[leaf], tree.hh_degree, d);
            for (int c = 0; c < 3; ++c) ASSERT_NEAR(colour[c], 1 / (1 + std::exp(-logits[c])), 5e-6);
        }
        EXPECT_GT(seen, 100u);
    }
}

TEST_F(PlenoctreeFormsTest, ZIsUpUnlessSomebodySaysOtherwise) {
    const N3Tree truth = random_n3tree(4, true, 9);  // its box is (−1, −1, −6) to (3, 1, 2)
    write_npz(file, truth.arrays());
    const voctree::ClipHeader header = voctree::read_clip_header(file);
    EXPECT_EQ(header.box_min, glm::vec3(-1, -6, -1));
    EXPECT_EQ(header.box_size, glm::vec3(4, 8, 2));
    const voctree::ClipSegment usual = voctree::read_clip_index(file).segments[0];
    const voctree::ClipSegment upright = voctree::read_clip_index(file, UpAxis::kY).segments[0];
    EXPECT_EQ(voctree::read_segment(usual).box_min, header.box_min);
    EXPECT_EQ(voctree::read_segment(upright).box_min, glm::vec3(-1, -1, -6));
    EXPECT_FALSE(voctree::read_segment(usual).has_srgb_colours);
    EXPECT_TRUE(voctree::read_shown_segment(usual).has_srgb_colours);
}

TEST_F(PlenoctreeFormsTest, OldTreesHaveOneInvradius) {
    N3Tree truth = random_n3tree(4, true, 9);
    truth.invradius = glm::vec3(0.25f);
    auto arrays = truth.arrays();
    const voctree::VOctree expected = read(arrays);
    arrays.erase("invradius3");
    for (const bool doubles : {true, false}) {
        arrays["invradius"] =
            doubles ? npy_bytes("<f8", {}, bytes_of<double>({0.25})) : npy_bytes("<f4", {1}, bytes_of<float>({0.25f}));
        const voctree::VOctree tree = read(arrays);
        EXPECT_EQ(tree.box_min, expected.box_min);
        EXPECT_EQ(tree.box_size, expected.box_size);
        EXPECT_EQ(tree.weights, expected.weights);
    }
    arrays["invradius"] = npy_bytes("<f8", {2}, bytes_of<double>({0.25, 0.25}));
    expect_input_error([&] { read(arrays); }, {"invradius", "one number"});
    arrays["invradius"] = npy_bytes("<f8", {}, bytes_of<double>({0}));
    expect_input_error([&] { read(arrays); }, {"invradius", "finite size"});
}

TEST_F(PlenoctreeFormsTest, AnInfiniteDensityIsTheLargestThatIsStored) {
    N3Tree truth = random_n3tree(4, true, 9);
    voctree::VOctree tree = read(truth.arrays());
    const uint64_t seen = [&] {
        for (uint64_t cell = 80;; ++cell)
            if (truth.child[cell] == 0 && truth.data[cell * truth.numbers() + 12] > 0) return cell;
    }();
    const std::vector<float> before = tree.weights;
    for (const bool halves : {false, true}) {
        // half_from_float would make it 65504, so an infinite half is written by its bits.
        truth.halves = halves;
        truth.data[seen * truth.numbers() + 12] = INFINITY;
        auto arrays = truth.arrays();
        std::string& data = arrays["data"];
        if (halves) {
            const size_t at = data.size() - 2 * truth.data.size() + 2 * (seen * truth.numbers() + 12);
            data[at] = 0;
            data[at + 1] = 0x7c;
        }
        tree = read(arrays);
        EXPECT_EQ(voctree::defect_of(tree), "");
        size_t changed = 0;
        for (size_t i = 0; i < before.size(); ++i) {
            if (tree.weights[i] == before[i]) continue;
            ++changed;
            EXPECT_EQ(i % tree.weights_per_leaf(), 0u);
            EXPECT_EQ(tree.weights[i], voctree::kMaxHalf);
        }
        EXPECT_EQ(changed, 1u);
    }
}

TEST_F(PlenoctreeFormsTest, TreesInNdcAreRefused) {
    write_npz(file, random_n3tree(4, true, 9).arrays());
    write_text(folder.path / "tree_poses_bounds.npy", "");
    expect_input_error([&] { voctree::read_plenoctree(file); }, {"tree.npz", "NDC", "tree_poses_bounds.npy"});
    expect_input_error([&] { voctree::read_clip_header(file); }, {"NDC"});
}

// A tree of SH4 as volrend compresses it, with palettes of 5 colours, and the same tree whole.
struct Quantised {
    static constexpr uint64_t kColours = 5;
    std::map<std::string, std::string> arrays, whole;

    explicit Quantised(uint64_t retained) {
        N3Tree tree = random_n3tree(4, true, 12);
        const uint64_t cells = tree.child.size(), palettes = 4 - retained;
        Random random(3);
        std::vector<uint16_t> colours, indices, sigma, kept;
        for (uint64_t i = 0; i < palettes * kColours * 3; ++i)
            colours.push_back(voctree::half_from_float(static_cast<float>(random.uniform(-3, 3))));
        for (uint64_t i = 0; i < palettes * cells; ++i)
            indices.push_back(static_cast<uint16_t>(random.below(kColours)));
        for (uint64_t i = 0; i < retained; ++i)
            for (uint64_t cell = 0; cell < cells; ++cell)
                for (uint64_t channel = 0; channel < 3; ++channel)
                    kept.push_back(voctree::half_from_float(tree.data[cell * 13 + channel * 4 + i]));
        for (uint64_t cell = 0; cell < cells; ++cell) {
            sigma.push_back(voctree::half_from_float(tree.data[cell * 13 + 12]));
            for (uint64_t i = 0; i < palettes; ++i)
                for (uint64_t channel = 0; channel < 3; ++channel)
                    tree.data[cell * 13 + channel * 4 + retained + i] =
                        voctree::float_from_half(colours[(i * kColours + indices[i * cells + cell]) * 3 + channel]);
        }
        whole = arrays = tree.arrays();
        arrays.erase("data");
        const uint64_t nodes = tree.nodes();
        arrays["quant_colors"] = npy_bytes("<f2", {palettes, kColours, 3}, bytes_of(colours));
        arrays["quant_map"] = npy_bytes("<u2", {palettes, nodes, 2, 2, 2}, bytes_of(indices));
        arrays["sigma"] = npy_bytes("<f2", {nodes, 2, 2, 2}, bytes_of(sigma));
        if (retained > 0) arrays["data_retained"] = npy_bytes("<f2", {retained, nodes, 2, 2, 2, 3}, bytes_of(kept));
    }
};

TEST_F(PlenoctreeFormsTest, QuantisedColoursAreThoseOfTheirPalettes) {
    for (const uint64_t retained : {0u, 1u, 3u}) {
        const Quantised tree(retained);
        const voctree::VOctree expected = read(tree.whole);
        EXPECT_EQ(read(tree.arrays).weights, expected.weights);
    }
}

TEST_F(PlenoctreeFormsTest, DamagedQuantisedTreesAreNamed) {
    const auto expect_refused = [&](const std::string& name, const std::string& array,
                                    std::initializer_list<std::string> parts) {
        auto arrays = Quantised(1).arrays;
        if (array.empty())
            arrays.erase(name);
        else
            arrays[name] = array;
        expect_input_error([&] { read(arrays); }, parts);
    };
    for (const char* name : {"quant_map", "sigma"}) expect_refused(name, "", {"tree.npz", name, "missing"});
    expect_refused("data_retained", "", {"data_format", "10 numbers"});
    expect_refused("quant_colors", npy_bytes("<f2", {3, 5}, std::string(30, 0)),
                   {"quant_colors", "(numbers, colours, 3)"});
    expect_refused("quant_colors", npy_bytes("<f2", {3, 0, 3}, ""), {"quant_colors"});
    expect_refused("quant_colors", npy_bytes("<f4", {3, 5, 3}, std::string(180, 0)), {"quant_colors", "<f2"});
    expect_refused("quant_colors", npy_bytes("<f2", {3, 1, 3}, std::string(18, 0)),
                   {"quant_map[", "does not exist (1 do)"});
    expect_refused("quant_map", npy_bytes("<u2", {2, kCapacity, 2, 2, 2}, std::string(32 * kCapacity, 0)),
                   {"quant_map", "<u2", "(3, 43, 2, 2, 2)"});
    expect_refused("quant_map", npy_bytes("<i2", {3, kCapacity, 2, 2, 2}, std::string(48 * kCapacity, 0)),
                   {"quant_map", "<u2"});
    expect_refused("sigma", npy_bytes("<f2", {1, 2, 2, 2}, std::string(16, 0)), {"sigma", "(43, 2, 2, 2)"});
    expect_refused("data_retained", npy_bytes("<f2", {}, "  "), {"data_retained"});
    expect_refused("data_retained", npy_bytes("<f2", {1, kCapacity, 2, 2, 2, 1}, std::string(16 * kCapacity, 0)),
                   {"data_retained", "(1, 43, 2, 2, 2, 3)"});
}

TEST_F(PlenoctreeFormsTest, AnyDamageOfAQuantisedTreeIsRefusedOrMakesASoundTree) {
    const auto sound = Quantised(1).arrays;
    Random random(12);
    uint32_t refused = 0;
    constexpr uint32_t kRounds = 300;
    for (uint32_t round = 0; round < kRounds; ++round) {
        auto arrays = sound;
        auto at = std::next(arrays.begin(), random.below(arrays.size()));
        for (uint32_t i = 0; i < 1 + random.below(3); ++i)
            at->second[random.below(at->second.size())] = static_cast<char>(random.below(256));
        try {
            ASSERT_EQ(voctree::defect_of(read(arrays)), "");
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, kRounds / 4);
    EXPECT_LT(refused, kRounds);
}

}  // namespace
}  // namespace neuvv::test
