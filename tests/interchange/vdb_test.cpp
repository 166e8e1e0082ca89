// OpenVDB files as we write them, read by OpenVDB itself, and clips that are made of such files.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"
#include "interchange/volume/vdb_volume.h"
#include "interchange/volume/vdb_writer.h"
#include "reference/hh.h"
#include "reference/slice.h"
#include "support/input_error.h"
#include "support/random_tree.h"
#include "support/temporary_folder.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using interchange::VdbVolume;

voctree::VOctree some_tree() {
    voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 2, .leaves = 300, .bases = 3, .hh_degree = 2});
    tree.box_min = {-0.5f, 0.25f, 1};
    tree.box_size = {2, 2, 2};
    return tree;
}

struct OpenFile {
    openvdb::GridPtrVecPtr grids;
    explicit OpenFile(const std::filesystem::path& path) {
        openvdb::initialize();
        openvdb::io::File file(path.string());
        file.open();
        grids = file.getGrids();
    }
    template <typename Grid>
    typename Grid::Ptr grid(const std::string& name) const {
        for (const auto& one : *grids)
            if (one->getName() == name) return openvdb::gridPtrCast<Grid>(one);
        return nullptr;
    }
};

VdbVolume read_volume(const std::filesystem::path& file, const glm::dmat4& world_from_file) {
    return interchange::volume_of(interchange::read_vdb(file).grids, file.string(), world_from_file);
}

template <typename Grid>
typename Grid::ValueType value_at(const Grid& grid, const glm::dvec3& world) {
    const openvdb::Vec3d index = grid.worldToIndex({world.x, world.y, world.z});
    return grid.getConstAccessor().getValue(openvdb::Coord::round(index));
}

glm::dvec3 point_in(const voctree::VOctree& tree, Random& random) {
    const glm::dvec3 share(random.uniform(), random.uniform(), random.uniform());
    return glm::dvec3(tree.box_min) + share * glm::dvec3(tree.box_size);
}

const slice::Leaf* leaf_at(const slice::Slice& volume, const glm::dvec3& world) {
    for (const slice::Leaf& leaf : volume.leaves) {
        const glm::dvec3 offset = glm::abs(world - glm::dvec3(volume.centre_m(leaf)));
        if (glm::all(glm::lessThan(offset, 0.5 * glm::dvec3(volume.edges_m(leaf))))) return &leaf;
    }
    return nullptr;
}

// The mean over a fine grid of directions.
glm::dvec3 mean_colour(const slice::Slice& volume, const slice::Leaf& leaf) {
    glm::dvec3 sum(0);
    double weights = 0;
    for (int i = 0; i < 24; ++i)
        for (int j = 0; j < 48; ++j) {
            const double polar = (i + 0.5) / 24 * std::numbers::pi, around = j / 24.0 * std::numbers::pi;
            const glm::dvec3 d(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar));
            const std::vector<double> basis = reference::sh_basis(volume.degree, d);
            weights += std::sin(polar);
            for (int c = 0; c < 3; ++c) {
                double logit = 0;
                for (size_t k = 0; k < basis.size(); ++k)
                    logit += basis[k] * double{leaf.colours[static_cast<size_t>(c)][k]};
                sum[c] += std::sin(polar) / (1 + std::exp(-logit));
            }
        }
    return sum / weights;
}

TEST(VdbWriter, HasTheLeavesOfTheFrame) {
    const voctree::VOctree tree = some_tree();
    const slice::Slice volume = voctree::slice_of(tree, 2);
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", volume);
    const OpenFile file(folder.path / "x.vdb");
    ASSERT_EQ(file.grids->size(), 2u);
    const auto density = file.grid<openvdb::FloatGrid>("density");
    const auto colour = file.grid<openvdb::Vec3SGrid>("Cd");
    ASSERT_TRUE(density && colour);
    EXPECT_EQ(density->getGridClass(), openvdb::GRID_FOG_VOLUME);
    EXPECT_TRUE(density->hasUniformVoxels());
    EXPECT_NEAR(density->voxelSize()[0], 2.0 / 16, 1e-9);
    uint64_t voxels = 0;
    bool has_large = false;
    for (const slice::Leaf& leaf : volume.leaves) {
        voxels += uint64_t{1} << 3 * (volume.depth - leaf.depth);
        has_large |= leaf.depth == 1;
    }
    EXPECT_EQ(density->activeVoxelCount(), voxels);
    EXPECT_TRUE(has_large);
    EXPECT_GT(density->tree().activeTileCount(), 0u) << "a leaf of 8 × 8 × 8 voxels is a tile";
    Random random(5);
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
        const glm::dvec3 world = point_in(tree, random);
        const slice::Leaf* leaf = leaf_at(volume, world);
        EXPECT_NEAR(double{value_at(*density, world)}, leaf ? double{leaf->sigma} : 0.0, leaf ? 1e-3 * leaf->sigma : 0);
        if (!leaf) continue;
        ++inside;
        const openvdb::Vec3s shown = value_at(*colour, world);
        if (inside % 20 != 0) continue;
        const glm::dvec3 mean = mean_colour(volume, *leaf);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(double{shown[c]}, mean[c], 0.01);
    }
    EXPECT_GT(inside, 300);
}

TEST(VdbWriter, MayBeTurnedAndMoved) {
    const voctree::VOctree tree = some_tree();
    const slice::Slice volume = voctree::slice_of(tree, 2);
    const TemporaryFolder folder;
    interchange::VdbOptions options;
    options.rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)));
    options.origin = {512350, 410, -5403210};
    interchange::write_vdb(folder.path / "x.vdb", volume, options);
    const OpenFile file(folder.path / "x.vdb");
    const auto density = file.grid<openvdb::FloatGrid>("density");
    ASSERT_TRUE(density);
    Random random(5);
    int inside = 0;
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 at = point_in(tree, random);
        const slice::Leaf* leaf = leaf_at(volume, at);
        const double sigma = leaf ? double{leaf->sigma} : 0;
        EXPECT_NEAR(double{value_at(*density, options.rotation * at + options.origin)}, sigma, 1e-3 * sigma);
        inside += leaf != nullptr;
    }
    EXPECT_GT(inside, 70);
    expect_input_error(
        [&] { interchange::volume_of(interchange::read_vdb(folder.path / "x.vdb").grids, "x.vdb", glm::dmat4(1)); },
        {"turned"});
}

// Through the file as a renderer walks it, and through the clip by the reference's slice.
TEST(VdbWriter, DimsRaysAsTheClipDoes) {
    const voctree::VOctree tree = some_tree();
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", voctree::slice_of(tree, 1));
    const auto density = OpenFile(folder.path / "x.vdb").grid<openvdb::FloatGrid>("density");
    ASSERT_TRUE(density);
    const auto slice = reference::slice_tree(tree, 1);
    const auto positions = voctree::leaf_positions(tree);
    Random random(9);
    double most = 0;
    for (int ray = 0; ray < 20; ++ray) {
        const glm::dvec3 from = point_in(tree, random), to = point_in(tree, random);
        double truth = 0, walked = 0;
        constexpr int kSteps = 20000;
        const double step = glm::distance(from, to) / kSteps;
        for (int i = 0; i < kSteps; ++i)
            walked += step * double{value_at(*density, glm::mix(from, to, (i + 0.5) / kSteps))};
        for (size_t i = 0; i < positions.size(); ++i) {
            const double edge = std::exp2(-double(positions[i].depth));
            if (1 - std::exp(-slice[i].sigma * 2 * edge) < 0.001) continue;  // too faint to be exported
            double near = 0, far = 1;
            for (int a = 0; a < 3; ++a) {
                const double low =
                    double{tree.box_min[a]} + 2 * edge * glm::uvec3(positions[i].x, positions[i].y, positions[i].z)[a];
                const double x = (low - from[a]) / (to[a] - from[a]),
                             y = (low + 2 * edge - from[a]) / (to[a] - from[a]);
                near = std::max(near, std::min(x, y));
                far = std::min(far, std::max(x, y));
            }
            truth += slice[i].sigma * std::max(0.0, far - near) * glm::distance(from, to);
        }
        EXPECT_NEAR(walked, truth, 0.002 * truth + 1e-3);
        most = std::max(most, truth);
    }
    EXPECT_GT(most, 0.5);
}

// Opaque leaves in a ball.
slice::Slice ball() {
    slice::Slice volume;
    volume.box_size = glm::vec3(2);
    volume.box_min = glm::vec3(-1);
    volume.depth = 6;
    for (uint64_t cell = 0; cell < uint64_t{1} << 18; ++cell) {
        slice::Leaf leaf{cell, 6, 500, {}, 1};
        if (glm::length(volume.centre_m(leaf)) < 0.6f) volume.leaves.push_back(leaf);
    }
    return volume;
}

TEST(VdbWriter, HasALevelSetWhereItIsAskedFor) {
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", ball(), {.surface_opacity = 0.5f});
    const auto surface = OpenFile(folder.path / "x.vdb").grid<openvdb::FloatGrid>("surface");
    ASSERT_TRUE(surface);
    EXPECT_EQ(surface->getGridClass(), openvdb::GRID_LEVEL_SET);
    const double voxel = surface->voxelSize()[0];
    EXPECT_NEAR(double{surface->background()}, 3 * voxel, 1e-6);
    size_t near = 0;
    for (auto value = surface->cbeginValueOn(); value; ++value, ++near) {
        const double radius = surface->indexToWorld(value.getCoord()).length();
        EXPECT_NEAR(double{*value}, radius - 0.6, 0.8 * voxel);
    }
    EXPECT_GT(near, 10000u);
    EXPECT_LT(value_at(*surface, {0, 0, 0}), 0);
    EXPECT_GT(value_at(*surface, {0.9, 0, 0}), 0);
    slice::Slice stretched = ball();
    stretched.box_size.x *= 1.5f;
    EXPECT_TRUE(interchange::has_cubic_cells(ball()));
    EXPECT_FALSE(interchange::has_cubic_cells(stretched));
    EXPECT_THROW(interchange::write_vdb(folder.path / "y.vdb", stretched, {.surface_opacity = 0.5f}), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder.path / "y.vdb"));
}

// Interpolation at the surface must not mix in black.
TEST(VdbWriter, GoesOnWithColoursAroundTheDensity) {
    slice::Slice volume = ball();
    for (slice::Leaf& leaf : volume.leaves) leaf.colours[0][0] = 20;
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", volume);
    const OpenFile file(folder.path / "x.vdb");
    const auto density = file.grid<openvdb::FloatGrid>("density");
    const auto colour = file.grid<openvdb::Vec3SGrid>("Cd");
    for (auto value = density->cbeginValueOn(); value; ++value)
        for (int i = 0; i < 27; ++i) {
            const openvdb::Coord at = value.getCoord().offsetBy(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            const openvdb::Vec3s shown = colour->getConstAccessor().getValue(at);
            ASSERT_NEAR(shown[0], 1, 0.01);
            ASSERT_NEAR(shown[1], 0.5, 0.01);
        }
}

// A clip's frame becomes a file, which becomes a clip.
TEST(VdbVolume, ComesBackAsItWas) {
    const voctree::VOctree tree = some_tree();
    const slice::Slice volume = voctree::slice_of(tree, 2);
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", volume);
    // Lengths are doubled, and (x, y, z) becomes (x, z, −y).
    const glm::dmat4 turned = glm::dmat4(2, 0, 0, 0, 0, 0, -2, 0, 0, 2, 0, 0, 0, 0, 0, 1);
    for (const glm::dmat4& world_from_file : {glm::dmat4(1), turned}) {
        const VdbVolume read = read_volume(folder.path / "x.vdb", world_from_file);
        const double scale = glm::length(glm::dvec3(world_from_file[0]));
        EXPECT_EQ(interchange::doublings_for(read, 16), 0u);
        const slice::Slice back = voctree::slice_of(interchange::tree_of(read, 0, 25), 0);
        Random random(5);
        for (int i = 0; i < 2000; ++i) {
            const glm::dvec3 point = point_in(tree, random);
            const slice::Leaf* truth = leaf_at(volume, point);
            const slice::Leaf* found = leaf_at(back, glm::dvec3(world_from_file * glm::dvec4(point, 1)));
            if (!truth || volume.optical_depth(*truth) < 0.02f) continue;  // split into leaves that are too faint
            ASSERT_TRUE(found);
            EXPECT_NEAR(found->sigma * scale, double{truth->sigma}, 1e-3 * truth->sigma);
            const glm::dvec3 shown = mean_colour(volume, *truth);
            for (int c = 0; c < 3 && i % 20 == 0; ++c)
                EXPECT_NEAR(mean_colour(back, *found)[c], std::clamp(shown[c], 0.002, 0.998), 0.01);
        }
    }
}

TEST(VdbVolume, HasLargerCellsWhereTheyAreAskedFor) {
    const TemporaryFolder folder;
    interchange::write_vdb(folder.path / "x.vdb", ball());
    const VdbVolume volume = read_volume(folder.path / "x.vdb", glm::dmat4(1));
    EXPECT_EQ(interchange::doublings_for(volume, 64), 0u);
    EXPECT_EQ(interchange::doublings_for(volume, 20), 1u);
    EXPECT_EQ(interchange::doublings_for(volume, 18), 2u) << "the ball is 38 voxels wide";
    VdbVolume empty = volume;
    empty.density.blocks.clear();
    empty.density.tiles.clear();
    EXPECT_EQ(interchange::doublings_for(empty, 18), std::nullopt);
    const slice::Slice small = voctree::slice_of(interchange::tree_of(volume, 0, 25), 0);
    const slice::Slice large = voctree::slice_of(interchange::tree_of(volume, 1, 25), 0);
    EXPECT_EQ(small.leaves.size(), ball().leaves.size());
    EXPECT_LT(large.leaves.size(), small.leaves.size() / 6);
    for (const slice::Leaf& leaf : large.leaves) EXPECT_NEAR(large.edge_m(leaf), 2 / 32.0, 1e-6);
    const slice::Leaf* centre = leaf_at(large, {0.01, 0.01, 0.01});
    ASSERT_TRUE(centre);
    EXPECT_NEAR(centre->sigma, 500, 5);
}

// A cube of haze, seen from the front.
}  // namespace
}  // namespace neuvv::test
