// Tests PlenOctrees against svox' evaluation of the same arrays, and that invalid files are refused.
#include "voctree/files/plenoctree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "media/image.h"
#include "reference/sample.h"
#include "reference/slice.h"
#include "reference/trace.h"
#include "support/input_error.h"
#include "support/n3_tree.h"
#include "support/npz_files.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/clip.h"
#include "voctree/files/half.h"
#include "voctree/files/nvv.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::test {
namespace {

double sigmoid(double x) {
    return 1 / (1 + std::exp(-x));
}

glm::dvec3 random_direction(Random& random) {
    return glm::normalize(glm::dvec3(random.bell(), random.bell(), random.bell()) + 1e-9);
}

struct PlenoctreeTest : ::testing::Test {
    TemporaryFolder folder;
    std::filesystem::path file = folder.path / "tree.npz";

    voctree::VOctree read(const N3Tree& tree, voctree::PlenoctreeColours colours, int32_t method = ZIP_CM_STORE) {
        write_npz(file, tree.arrays(), method);
        return voctree::read_plenoctree(file, colours, voctree::UpAxis::kY);  // in the file's axes
    }
};

TEST_F(PlenoctreeTest, EveryFormatIsTheFieldThatSvoxSees) {
    uint64_t seed = 1;
    for (const uint32_t functions : {0u, 1u, 4u, 9u, 16u})
        for (const bool halves : {true, false})
            for (const int32_t method : {ZIP_CM_STORE, ZIP_CM_DEFLATE}) {
                SCOPED_TRACE(functions);
                const N3Tree truth = random_n3tree(functions, halves, seed++);
                const voctree::VOctree tree = read(truth, voctree::PlenoctreeColours::kAsStored, method);
                ASSERT_EQ(voctree::defect_of(tree), "");
                EXPECT_EQ(tree.frames, 1u);
                EXPECT_EQ(tree.bases, 1u);
                const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
                Random random(seed);
                uint32_t seen = 0;
                for (int i = 0; i < 500; ++i) {
                    const glm::dvec3 in_tree(random.uniform(), random.uniform(), random.uniform());
                    const float* expected =
                        truth.query((in_tree - glm::dvec3(truth.offset)) / glm::dvec3(truth.invradius));
                    const float sigma = expected[truth.numbers() - 1];
                    const uint32_t leaf = voctree::find_leaf(tree, in_tree);
                    ASSERT_EQ(leaf != UINT32_MAX, sigma > 0);
                    if (leaf == UINT32_MAX) continue;
                    ++seen;
                    ASSERT_EQ(slices[leaf].sigma, double{sigma});
                    const glm::dvec3 direction = random_direction(random), logits = truth.logits(expected, direction);
                    const glm::dvec3 colour = reference::sample_colour(slices[leaf], tree.hh_degree, direction);
                    for (int c = 0; c < 3; ++c) ASSERT_NEAR(colour[c], sigmoid(logits[c]), 2e-6);
                }
                EXPECT_GT(seen, 100u);
            }
}

TEST_F(PlenoctreeTest, CoefficientsAreTheFilesWithTurnedSigns) {
    const N3Tree truth = random_n3tree(9, true, 5);
    const voctree::VOctree tree = read(truth, voctree::PlenoctreeColours::kAsStored);
    const auto slices = reference::slice_tree(tree, 0);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const double signs[] = {1, -1, 1, -1, 1, -1, 1, -1, 1};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        const voctree::LeafPosition& position = positions[leaf];
        const glm::dvec3 centre =
            (glm::dvec3(position.x, position.y, position.z) + 0.5) * std::ldexp(1.0, -int(position.depth));
        const float* expected = truth.query((centre - glm::dvec3(truth.offset)) / glm::dvec3(truth.invradius));
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < 9; ++i)
                ASSERT_NEAR(slices[leaf].k[c][i], signs[i] * double{expected[9 * c + i]}, 5e-7);
    }
}

// Transmittance along rays in the world, where cells are not cubes, by svox' steps: lengths are those of the world.
TEST_F(PlenoctreeTest, RaysAreAttenuatedAsInSvox) {
    const N3Tree truth = random_n3tree(4, true, 9);
    const voctree::VOctree tree = read(truth, voctree::PlenoctreeColours::kAsStored);
    EXPECT_EQ(tree.box_min, glm::vec3(-1, -1, -6));
    EXPECT_EQ(tree.box_size, glm::vec3(4, 2, 8));
    const auto slices = reference::slice_tree(tree, 0);
    Random random(3);
    const glm::dvec3 scale(truth.invradius);
    for (int i = 0; i < 100; ++i) {
        const glm::dvec3 from =
            (glm::dvec3(random.uniform(), random.uniform(), random.uniform()) - glm::dvec3(truth.offset)) / scale;
        const glm::dvec3 direction = random_direction(random), unit = glm::normalize(direction * scale);
        const double metres = 1 / glm::length(direction * scale);  // per unit of length in the tree
        const glm::dvec3 origin = glm::dvec3(truth.offset) + scale * from;
        double optical_depth = 0;
        for (double t = 0;;) {
            const glm::dvec3 at = origin + t * unit;
            if (glm::any(glm::lessThan(at, glm::dvec3(0))) || glm::any(glm::greaterThanEqual(at, glm::dvec3(1)))) break;
            double side = 0, exit = 1e9;
            const float* leaf = truth.query((at - glm::dvec3(truth.offset)) / scale, &side);
            for (int axis = 0; axis < 3; ++axis) {
                const double low = std::floor(at[axis] / side) * side;
                exit = std::min(exit, ((unit[axis] > 0 ? low + side : low) - at[axis]) / unit[axis]);
            }
            const double step = std::max(exit, 0.0) + 1e-9;
            optical_depth += std::max(0.0, double{leaf[truth.numbers() - 1]}) * step * metres;
            t += step;
        }
        EXPECT_NEAR(reference::trace(tree, slices, {from, direction}).alpha, 1 - std::exp(-optical_depth), 1e-6);
    }
}

TEST_F(PlenoctreeTest, BoxOfLeavesIsKnownWithoutTheirColours) {
    write_npz(file, random_n3tree(9, true, 3).arrays(), ZIP_CM_STORE);
    for (const voctree::UpAxis up : {voctree::UpAxis::kY, voctree::UpAxis::kZ})
        EXPECT_EQ(voctree::read_plenoctree_leaf_box(file, up),
                  voctree::occupied_box(voctree::read_plenoctree(file, voctree::PlenoctreeColours::kAsStored, up)));
}

// Colours on a display are those of the file: exactly where they do not depend on the direction, else nearly.
TEST_F(PlenoctreeTest, ColoursAreDecodedToLinearLight) {
    const struct {
        uint32_t functions;
        double worst, mean;  // differences of sRGB, 0 to 1
    } cases[] = {{0, 1e-5, 1e-5}, {1, 1e-5, 1e-5}, {4, 0.02, 0.003}, {9, 0.02, 0.003}, {16, 0.02, 0.003}};
    for (const auto& c : cases) {
        SCOPED_TRACE(c.functions);
        N3Tree truth = random_n3tree(c.functions, false, 20 + c.functions);
        for (size_t i = 0; i < truth.data.size(); ++i)  // most of a colour does not depend on the direction
            if (c.functions > 1 && i % truth.numbers() % c.functions != 0) truth.data[i] *= 0.2f;
        const voctree::VOctree tree = read(truth, voctree::PlenoctreeColours::kLinear);
        const voctree::VOctree stored = read(truth, voctree::PlenoctreeColours::kAsStored);
        EXPECT_NE(tree.weights, stored.weights);
        const auto slices = reference::slice_tree(tree, 0), as_stored = reference::slice_tree(stored, 0);
        Random random(4);
        double worst = 0, sum = 0;
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            for (int i = 0; i < 20; ++i) {
                const glm::dvec3 direction = random_direction(random);
                const glm::dvec3 linear = reference::sample_colour(slices[leaf], tree.hh_degree, direction);
                const glm::dvec3 expected = reference::sample_colour(as_stored[leaf], tree.hh_degree, direction);
                for (int channel = 0; channel < 3; ++channel) {
                    const double off = std::abs(media::srgb_from_linear(linear[channel]) - expected[channel]);
                    worst = std::max(worst, off);
                    sum += off / (60.0 * tree.leaf_count);
                }
            }
        EXPECT_LE(worst, c.worst);
        EXPECT_LE(sum, c.mean);
    }
}

TEST_F(PlenoctreeTest, OldFilesNameNoFormat) {
    for (const uint32_t functions : {0u, 9u}) {
        const N3Tree truth = random_n3tree(functions, true, 6);
        auto arrays = truth.arrays();
        write_npz(file, arrays);
        const voctree::VOctree named = voctree::read_plenoctree(file);
        arrays.erase("data_format");
        write_npz(file, arrays);
        EXPECT_EQ(voctree::read_plenoctree(file).weights, named.weights);
    }
}

TEST_F(PlenoctreeTest, IsAClipOfOneFrame) {
    write_npz(file, random_n3tree(9, true, 7).arrays());
    const voctree::VOctree tree = voctree::read_plenoctree(file);
    EXPECT_EQ(voctree::kind_of(file), voctree::ClipKind::kPlenoctree);
    EXPECT_EQ(voctree::read_clip(file).weights, tree.weights);
    voctree::write_nvv(folder.path / "tree.nvv", tree);
    EXPECT_EQ(voctree::kind_of(folder.path / "tree.nvv"), voctree::ClipKind::kNvv);
    EXPECT_EQ(voctree::read_clip(folder.path / "tree.nvv").leaf_count, tree.leaf_count);
    for (const std::filesystem::path& path : {file, folder.path / "tree.nvv"}) {
        const voctree::ClipHeader header = voctree::read_clip_header(path);
        EXPECT_EQ(header.frames, 1u);
        EXPECT_EQ(header.fps, tree.fps);
        EXPECT_EQ(header.box_min, tree.box_min);
        EXPECT_EQ(header.box_size, tree.box_size);
    }
}

TEST_F(PlenoctreeTest, DamageIsNamed) {
    const N3Tree sound = random_n3tree(9, true, 8);
    const auto expect_refused = [&](const std::function<void(N3Tree&)>& damage,
                                    std::initializer_list<std::string> parts) {
        N3Tree tree = sound;
        damage(tree);
        expect_input_error([&] { read(tree, voctree::PlenoctreeColours::kLinear); }, parts);
    };
    const auto leaf = [&](uint64_t from) {  // a leaf that is reached and has σ > 0
        for (uint64_t cell = from;; ++cell)
            if (sound.child[cell] == 0 && sound.data[cell * sound.numbers() + 27] > 0) return cell;
    };
    const uint64_t last = 8 * (kNodes - 1);
    expect_refused([&](N3Tree& t) { t.child[last] = -int(kNodes - 1); },
                   {"tree.npz", "child[39, 0, 0, 0]", "more than once"});
    expect_refused([&](N3Tree& t) { t.child[last + 3] = -1; }, {"node 38 is reached more than once"});
    expect_refused([&](N3Tree& t) { t.child[last] = 4; }, {"node 43 does not exist (43 do)"});
    expect_refused([&](N3Tree& t) { t.child[last] = INT32_MIN; }, {"node -2147483609 does not exist"});
    expect_refused([&](N3Tree& t) { t.child[last] = INT32_MAX; }, {"does not exist"});
    const uint64_t seen = leaf(80);
    for (const float bad : {std::nanf(""), INFINITY, 2e9f})
        expect_refused(
            [&](N3Tree& t) {
                t.halves = false;
                t.data[seen * 28 + 3] = bad;
            },
            {"data[" + std::to_string(seen / 8), "number 3 is ", "no coefficient"});
    expect_refused([&](N3Tree& t) { t.data[seen * 28 + 27] = std::nanf(""); },
                   {"data[" + std::to_string(seen / 8), "density is not a number"});
    expect_refused([](N3Tree& t) { t.invradius.y = 0; }, {"invradius3", "box"});
    expect_refused([](N3Tree& t) { t.invradius.y = -1; }, {"invradius3"});
    expect_refused([](N3Tree& t) { t.invradius.x = std::nanf(""); }, {"invradius3"});
    expect_refused([](N3Tree& t) { t.offset.z = INFINITY; }, {"invradius3"});
    expect_refused(
        [](N3Tree& t) {
            for (uint64_t cell = 0; cell < t.child.size(); ++cell) t.data[cell * 28 + 27] = -1;
        },
        {"empty everywhere"});
    expect_refused(
        [](N3Tree& t) {  // a chain
            for (uint64_t node = 0; node < kCapacity; ++node)
                for (uint64_t cell = 0; cell < 8; ++cell)
                    t.child[8 * node + cell] = cell == 0 && node + 1 < kCapacity ? 1 : 0;
        },
        {"child[11, 0, 0, 0]", "deeper than 12"});
}

TEST_F(PlenoctreeTest, OtherArraysAreRefused) {
    const N3Tree tree = random_n3tree(4, true, 8);
    const auto expect_refused = [&](const std::string& name, const std::string& array,
                                    std::initializer_list<std::string> parts) {
        auto arrays = tree.arrays();
        arrays[name] = array;
        write_npz(file, arrays);
        expect_input_error([&] { voctree::read_plenoctree(file); }, parts);
    };
    for (const char* name : {"child", "data", "offset", "invradius3"}) {
        auto arrays = tree.arrays();
        arrays.erase(name);
        write_npz(file, arrays);
        expect_input_error([&] { voctree::read_plenoctree(file); }, {"tree.npz", name, "missing"});
    }
    const auto text = [](const std::string& letters) {
        std::string wide;
        for (const char letter : letters) wide += {letter, 0, 0, 0};
        return npy_bytes("<U" + std::to_string(letters.size()), {}, wide);
    };
    expect_refused("data_format", text("SG4"), {"data_format", "SG4"});
    expect_refused("data_format", text("SH25"), {"SH25"});
    expect_refused("data_format", text("SH9"), {"data_format", "13 numbers"});
    expect_refused("data_format", text("\n\x1b[31m"), {"data_format", "??[31m"});
    expect_refused("data_format", npy_bytes("<i4", {}, bytes_of<int32_t>({4})), {"no text"});
    expect_refused("child", npy_bytes("<i4", {1, 3, 3, 3}, std::string(108, 0)), {"child", "(nodes, 2, 2, 2)"});
    expect_refused("child", npy_bytes("<i8", {1, 2, 2, 2}, std::string(64, 0)), {"child", "<i4"});
    expect_refused("child", npy_bytes("<i4", {0, 2, 2, 2}, ""), {"child"});
    expect_refused("child", npy_bytes("<i4", {1, 2, 2, 2}, std::string(32, 0)), {"data", "(nodes, 2, 2, 2, numbers)"});
    expect_refused("child", npy_bytes("<i4", {kCapacity, 2, 2, 2}, std::string(32, 0)), {"child", "32 bytes"});
    expect_refused("data", npy_bytes("<f2", {kCapacity, 2, 2, 2, 1}, std::string(16 * kCapacity, 0)), {"data"});
    expect_refused("data", npy_bytes("<f8", {1}, std::string(8, 0)), {"data", "<f2"});
    expect_refused("offset", npy_bytes("<f4", {2}, std::string(8, 0)), {"offset", "three"});
    write_text(file, "PK\3\4 and no more");
    expect_input_error([&] { voctree::read_clip(file); }, {"tree.npz"});
    expect_input_error([&] { voctree::read_clip(folder.path / "missing.npz"); }, {"missing.npz"});
}

TEST_F(PlenoctreeTest, SmallFilesAskForLittle) {
    auto arrays = random_n3tree(9, true, 8).arrays();
    arrays["padding"] = npy_bytes("|u1", {size_t{100} << 20}, std::string(size_t{100} << 20, 0));
    write_npz(file, arrays, ZIP_CM_DEFLATE);
    ASSERT_LT(std::filesystem::file_size(file), 300'000u);
    expect_input_error([&] { voctree::read_plenoctree(file); }, {"padding", "too large"});
}

// A flipped bit of the file is noticed, by the checksums if by nothing else, unless it is one that says nothing.
TEST_F(PlenoctreeTest, FlippedBitsAreNoticed) {
    write_npz(file, random_n3tree(4, true, 8).arrays(), ZIP_CM_DEFLATE);
    const voctree::VOctree sound = voctree::read_plenoctree(file);
    std::ifstream from(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(from), {}};
    Random random(5);
    uint32_t refused = 0;
    constexpr uint32_t kRounds = 200;
    for (uint32_t round = 0; round < kRounds; ++round) {
        std::string damaged = bytes;
        damaged[random.below(bytes.size())] ^= static_cast<char>(1 << random.below(8));
        write_text(file, damaged);
        try {
            ASSERT_EQ(voctree::read_plenoctree(file).weights, sound.weights);
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, kRounds / 2);
}

// Damage with valid zip checksums.
TEST_F(PlenoctreeTest, AnyDamageIsRefusedOrMakesASoundTree) {
    N3Tree tree = random_n3tree(4, true, 8);
    const auto sound = tree.arrays();
    Random random(12);
    uint32_t refused = 0;
    constexpr uint32_t kRounds = 400;
    for (uint32_t round = 0; round < kRounds; ++round) {
        auto arrays = sound;
        auto at = std::next(arrays.begin(), random.below(arrays.size()));
        for (uint32_t i = 0; i < 1 + random.below(3); ++i)
            at->second[random.below(at->second.size())] = static_cast<char>(random.below(256));
        write_npz(file, arrays);
        try {
            ASSERT_EQ(voctree::defect_of(voctree::read_plenoctree(file)), "");
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, kRounds / 4);
    EXPECT_LT(refused, kRounds);
}

}  // namespace
}  // namespace neuvv::test
