// Tests that the coarse tree has the coverage and colour of the leaves that it replaces, and that files store it
// correctly.
#include "voctree/coarse.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "support/nvv_bytes.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/files/nvv.h"
#include "voctree/temporal_basis.h"

namespace neuvv::test {
namespace {

// σ of a leaf in a frame.
double density(const voctree::VOctree& tree, uint32_t leaf, uint32_t frame) {
    double sigma = 0;
    for (uint32_t c = 0; c < tree.bases; ++c)
        sigma += double{tree.sigma_basis[frame * tree.bases + c]} * double{tree.leaf(leaf)[c]};
    return std::max(sigma, 0.0);
}

// The density that passes as much light along an edge of a cell of `tree` as its octants, the leaves of `fine`, do in
// the mean over its faces, along the axis on which they pass most.
double density_of_octants(const voctree::VOctree& fine, const voctree::LeafPosition& cell, uint32_t frame) {
    const double edge_m = double{voctree::leaf_edge_m(fine, cell.depth)};
    double optical_depth[2][2][2] = {}, most = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const glm::dvec3 octant(i & 1, i >> 1 & 1, i >> 2);
        const glm::dvec3 at =
            (glm::dvec3(cell.x, cell.y, cell.z) + 0.5 * octant + 0.25) * std::ldexp(1.0, -static_cast<int>(cell.depth));
        const uint32_t leaf = voctree::find_leaf(fine, at);
        if (leaf != UINT32_MAX) optical_depth[i & 1][i >> 1 & 1][i >> 2] = density(fine, leaf, frame) * edge_m / 2;
    }
    for (int axis = 0; axis < 3; ++axis) {
        double through = 0;
        for (int a = 0; a < 2; ++a)
            for (int b = 0; b < 2; ++b) {
                double depth = 0;
                for (int c = 0; c < 2; ++c)
                    depth += axis == 0   ? optical_depth[c][a][b]
                             : axis == 1 ? optical_depth[a][c][b]
                                         : optical_depth[a][b][c];
                through += std::exp(-depth) / 4;
            }
        most = std::max(most, through);
    }
    return -std::log(most) / edge_m;
}

void give_own_bases(voctree::VOctree& tree) {
    for (uint32_t i = 0; i < tree.frames * tree.bases; ++i)
        tree.sigma_basis[i] = i / tree.bases == i % tree.bases ? 1.0f : 0.0f;
    tree.gamma_basis = tree.sigma_basis;
}

voctree::VOctree five_frames_tree() {
    voctree::VOctree tree =
        random_tree({.seed = 3, .node_levels = 3, .leaves = 4000, .bases = 5, .hh_degree = 1, .frames = 5});
    give_own_bases(tree);
    return tree;
}

TEST(Coarse, CellsPassAsMuchLightAsTheirOctants) {
    voctree::VOctree fine = five_frames_tree();
    for (float& row : fine.sigma_basis) row *= 20;  // so that leaves are nearly opaque
    for (uint32_t depth = voctree::finest_depth(fine) - 1; depth >= 1; --depth) {
        const voctree::VOctree cut = voctree::cut_tree(fine, depth);
        EXPECT_EQ(voctree::defect_of(cut), "");
        EXPECT_LT(cut.leaf_count, fine.leaf_count);
        const std::vector<voctree::LeafPosition> cells = voctree::leaf_positions(cut);
        double largest = 0;
        for (uint32_t leaf = 0; leaf < cut.leaf_count; ++leaf) {
            ASSERT_LE(cells[leaf].depth, depth);
            for (uint32_t frame = 0; frame < fine.frames; ++frame) {
                const double truth = density_of_octants(fine, cells[leaf], frame), found = density(cut, leaf, frame);
                if (cells[leaf].depth == depth) {
                    EXPECT_NEAR(found, truth, 1e-4 * truth + 1e-4) << depth;
                }
                largest = std::max(largest, truth);
            }
        }
        EXPECT_GT(largest, 1);
        fine = cut;
    }
}

TEST(Coarse, CutsAtOnceAreCutsDepthByDepth) {
    const voctree::VOctree tree = five_frames_tree();
    EXPECT_EQ(voctree::cut_tree(tree, 6).weights, tree.weights);
    EXPECT_EQ(voctree::cut_tree(tree, 3).weights,
              voctree::cut_tree(voctree::cut_tree(voctree::cut_tree(tree, 5), 4), 3).weights);
}

// Opaque leaves that fill one half of a cell, a quarter, or an eighth of it.
TEST(Coarse, OpaqueLeavesCoverWhatTheyCover) {
    const auto light_through = [](const std::vector<uint32_t>& octants) {
        voctree::VOctree tree = random_tree({.leaves = 1, .bases = 1, .hh_degree = 0, .frames = 1});
        give_own_bases(tree);
        tree.node_levels = 1;
        std::vector<voctree::LeafPosition> positions;
        for (const uint32_t i : octants) positions.push_back({i & 1, i >> 1 & 1, i >> 2, 2});
        voctree::build_topology(tree, positions);
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) tree.leaf(leaf)[0] = 1e4f;
        const voctree::VOctree cut = voctree::cut_tree(tree, 1);
        return std::exp(-density(cut, 0, 0) * double{voctree::leaf_edge_m(cut, 1)});
    };
    EXPECT_NEAR(light_through({0, 2, 4, 6}), 0.5, 1e-5);  // a wall of one leaf, as seen along it
    EXPECT_NEAR(light_through({0, 1}), 0.75, 1e-5);
    EXPECT_NEAR(light_through({5}), 0.75, 1e-5);
    EXPECT_NEAR(light_through({0, 1, 2, 3, 4, 5, 6, 7}), 0, 1e-5);
}

// Every point inside a leaf of the tree is inside a leaf of the coarse tree, and the coarse tree adds only whole cells.
TEST(Coarse, LeavesStayWhereTheyWere) {
    const voctree::VOctree tree = five_frames_tree(), cut = voctree::cut_tree(tree, 3);
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 at(random.uniform(), random.uniform(), random.uniform());
        if (voctree::find_leaf(tree, at) != UINT32_MAX) {
            EXPECT_NE(voctree::find_leaf(cut, at), UINT32_MAX);
        }
    }
}

// Of eight siblings one is opaque and red, the others are nearly transparent and blue: the cell is red.
TEST(Coarse, WhatShowsGivesTheColour) {
    voctree::VOctree tree = random_tree({.leaves = 1, .bases = 2, .hh_degree = 0, .frames = 2});
    give_own_bases(tree);
    tree.node_levels = 1;
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < 8; ++i) positions.push_back({i & 1, i >> 1 & 1, i >> 2, 2});
    voctree::build_topology(tree, positions);
    for (uint32_t i = 0; i < 8; ++i) {
        const float numbers[] = {i == 5 ? 80.0f : 0.001f, -3, i == 5 ? 2.0f : -2.0f, 9, i == 5 ? 4.0f : -4.0f, 0, 1};
        std::copy(std::begin(numbers), std::end(numbers), tree.leaf(i));
    }
    const voctree::VOctree cut = voctree::cut_tree(tree, 1);
    ASSERT_EQ(cut.leaf_count, 1u);
    EXPECT_NEAR(cut.leaf(0)[0], density_of_octants(tree, {0, 0, 0, 1}, 0), 1e-4);
    EXPECT_GT(cut.leaf(0)[0], 0.1f);
    EXPECT_EQ(cut.leaf(0)[1], 0);  // empty in frame 1
    EXPECT_NEAR(cut.leaf(0)[2], 2, 0.05);
    EXPECT_EQ(cut.leaf(0)[3], 0);
    EXPECT_NEAR(cut.leaf(0)[4], 4, 0.05);
    EXPECT_NEAR(cut.leaf(0)[6], 1, 1e-5);
}

TEST(Coarse, LargeTreesHaveOneSmallTreesNone) {
    voctree::VOctree tree = random_tree({.leaves = 1, .bases = 1, .hh_degree = 0, .frames = 1});
    EXPECT_FALSE(voctree::coarse_tree(tree));
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < voctree::kMinLeavesForCoarse; ++i) positions.push_back({i % 64, i / 64 % 64, i / 4096, 6});
    tree.node_levels = 3;
    voctree::build_topology(tree, positions);
    for (uint32_t i = 0; i < tree.leaf_count; ++i) tree.leaf(i)[0] = 5;
    const std::optional<voctree::VOctree> coarse = voctree::coarse_tree(tree);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(voctree::defect_of(*coarse), "");
    EXPECT_LE(coarse->leaf_count, tree.leaf_count / 32);
    EXPECT_GT(coarse->leaf_count, tree.leaf_count / 512);
}

class CoarseFile : public testing::Test {
  protected:
    // Chunks of a file with a coarse tree, which `damage` may change.
    std::vector<Chunk> chunks(const voctree::VOctree& coarse) const {
        std::vector<Chunk> all = chunks_of(tree);
        std::vector<Chunk> own = chunks_of(coarse);
        for (Chunk& chunk : own) chunk.name[0] = static_cast<char>(chunk.name[0] - 'A' + 'a');
        all.insert(all.begin() + 1, own.begin(), own.end());
        return all;
    }
    std::string complaint(const std::vector<Chunk>& chunks) {
        write_bytes(path, nvv_of(chunks));
        try {
            voctree::read_nvv_coarse(path);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }
    void expect_complaint(const std::string& words, const std::vector<Chunk>& chunks) {
        const std::string found = complaint(chunks);
        EXPECT_NE(found.find(words), std::string::npos) << "expected: " << words << "\nfound: " << found;
        EXPECT_EQ(found.find(path.string()), 0u) << found;
        EXPECT_EQ(found.find('\n'), std::string::npos);
    }

    TemporaryFolder folder;
    std::filesystem::path path = folder.path / "tree.nvv";
    voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 2, .leaves = 60, .bases = 2, .frames = 2});
    voctree::VOctree cut = voctree::cut_tree(tree, 2);
};

TEST_F(CoarseFile, RoundTripAndTheBytesOfTheSpecification) {
    for (float& weight : cut.weights) weight = voctree::float_from_half(voctree::half_from_float(weight));
    voctree::write_nvv(path, tree, {{"note", std::vector<uint8_t>{1, 2}}}, 1, cut);
    const std::optional<voctree::VOctree> coarse = voctree::read_nvv_coarse(path);
    ASSERT_TRUE(coarse);
    EXPECT_EQ(coarse->weights, cut.weights);
    EXPECT_EQ(coarse->children, cut.children);
    EXPECT_EQ(coarse->frames, tree.frames);
    std::vector<voctree::NvvChunk> extra;
    EXPECT_EQ(voctree::read_nvv(path, &extra).weights, tree.weights);
    ASSERT_EQ(extra.size(), 1u) << "the coarse tree is no extra chunk";

    voctree::write_nvv(path, tree, {}, 1, cut);
    EXPECT_EQ(read_bytes(path), nvv_of(chunks(cut)));
    voctree::write_nvv(path, tree);
    EXPECT_FALSE(voctree::read_nvv_coarse(path));
}

// The coarse tree can be read from the beginning of the file alone.
TEST_F(CoarseFile, IsReadFromTheFilesStart) {
    voctree::write_nvv(path, tree, {}, 1, cut);
    Bytes bytes = read_bytes(path);
    bytes[bytes.size() - 60] ^= 1;
    write_bytes(path, bytes);
    EXPECT_TRUE(voctree::read_nvv_coarse(path));
    EXPECT_THROW(voctree::read_nvv(path), InputError);
    bytes[12 + 32 + 100] ^= 1;
    write_bytes(path, bytes);
    EXPECT_THROW(voctree::read_nvv_coarse(path), InputError);
}

TEST_F(CoarseFile, HostileOnesAreRefused) {
    EXPECT_EQ(complaint(chunks(cut)), "");
    const auto with = [&](const std::function<void(voctree::VOctree&)>& damage) {
        voctree::VOctree damaged = cut;
        damage(damaged);
        return chunks(damaged);
    };
    expect_complaint("chunk hEAD: has another clip or box", with([](voctree::VOctree& t) { t.frames = 9; }));
    expect_complaint("chunk hEAD: has another clip or box", with([](voctree::VOctree& t) { t.box_min.x = 7; }));
    std::vector<Chunk> many_bases = chunks(cut);
    many_bases[1].raw[16] = 65;
    expect_complaint("chunk hEAD: bases is 65", many_bases);
    expect_complaint("chunk cHLD: node 0", with([](voctree::VOctree& t) { t.children[0] = 0; }));
    expect_complaint("the coarse tree: weights: number 5 is not finite",
                     with([](voctree::VOctree& t) { t.weights[5] = std::nanf(""); }));
    std::vector<Chunk> less = chunks(cut);
    less.erase(less.begin() + 4);
    expect_complaint("is where chunk bASA must be", less);
    std::vector<Chunk> cut_off(less.begin(), less.begin() + 3);
    expect_complaint("is where chunk cHLD must be", cut_off);
    std::vector<Chunk> lying = chunks(cut);
    lying[2].claimed_raw_bytes = uint64_t{1} << 40;
    expect_complaint("chunk nODE: claims", lying);
}

// Damage with valid checksums is refused, or gives a valid tree.
TEST_F(CoarseFile, FuzzOfContent) {
    Random random(5);
    int refused = 0, accepted = 0;
    for (int round = 0; round < 3000; ++round) {
        std::vector<Chunk> all = chunks(cut);
        Chunk& chunk = all[1 + random.below(9)];
        const size_t at = random.below(chunk.raw.size());
        const uint32_t kind = random.below(6);
        if (kind == 0) chunk.raw.resize(at);
        if (kind == 1) chunk.claimed_raw_bytes = random.engine() >> random.below(64);
        if (kind == 2) std::swap(chunk, all[random.below(all.size())]);
        if (kind >= 3) chunk.raw[at] = static_cast<uint8_t>(kind == 3 ? 255 : chunk.raw[at] ^ 1 << random.below(8));
        write_bytes(path, nvv_of(all));
        try {
            const std::optional<voctree::VOctree> coarse = voctree::read_nvv_coarse(path);
            ASSERT_EQ(coarse ? voctree::defect_of(*coarse) : "", "");
            ++accepted;
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 500);
    EXPECT_GT(accepted, 500);
}

TEST_F(CoarseFile, WhatReadersRefuseIsNotWritten) {
    voctree::VOctree other = cut;
    other.frames = 1;
    EXPECT_THROW(voctree::write_nvv(path, tree, {}, 1, other), RuntimeFailure);
    other = cut;
    other.fps = 60;
    EXPECT_THROW(voctree::write_nvv(path, tree, {}, 1, other), RuntimeFailure);
    EXPECT_THROW(voctree::write_nvv(path, cut, {}, 1, tree), RuntimeFailure) << "more leaves than the tree";
    EXPECT_THROW(voctree::write_nvv(path, tree, {{"hEAD", std::vector<uint8_t>{1}}}), RuntimeFailure);
    EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace neuvv::test
