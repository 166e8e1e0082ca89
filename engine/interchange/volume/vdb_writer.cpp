#include "interchange/volume/vdb_writer.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetRebuild.h>
#include <openvdb/tools/Morphology.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <sstream>

#include "base/error.h"
#include "base/platform.h"
#include "voctree/files/half.h"
#include "voctree/sh_weights.h"

namespace neuvv::interchange {

namespace {

// Boxes of clips are cubes up to rounding; many programs read cubes alone.
constexpr float kMostStretch = 1e-5f;
constexpr float kSurfaceVoxels = 3;

openvdb::Vec3s mean_colour(const slice::Leaf& leaf, uint32_t degree) {
    openvdb::Vec3s mean(0);
    for (const voctree::ShDirection& direction : voctree::sh_directions()) {
        const auto basis = voctree::sh_basis(direction.d);
        for (int c = 0; c < 3; ++c) {
            double logit = 0;
            for (uint32_t i = 0; i < sh_count(degree); ++i)
                logit += basis[i] * double{leaf.colours[static_cast<size_t>(c)][i]};
            mean[c] += static_cast<float>(direction.weight / (4 * std::numbers::pi) / (1 + std::exp(-logit)));
        }
    }
    return mean;
}

openvdb::math::Transform::Ptr transform_of(const slice::Slice& volume, uint32_t depth) {
    const glm::dvec3 edges = glm::dvec3(volume.box_size) / std::exp2(depth);
    const glm::dvec3 centre = glm::dvec3(volume.box_min) + 0.5 * edges;
    const double mean = (edges.x + edges.y + edges.z) / 3;
    const openvdb::Vec3d at(centre.x, centre.y, centre.z);
    using namespace openvdb::math;
    if (has_cubic_cells(volume))
        return std::make_shared<Transform>(std::make_shared<UniformScaleTranslateMap>(mean, at));
    return std::make_shared<Transform>(
        std::make_shared<ScaleTranslateMap>(openvdb::Vec3d(edges.x, edges.y, edges.z), at));
}

template <typename Grid>
typename Grid::Ptr grid_of(const char* name, const openvdb::math::Transform::Ptr& transform) {
    auto grid = Grid::create();
    grid->setName(name);
    grid->setTransform(transform);
    grid->setSaveFloatAsHalf(true);
    grid->setCreator("NeuVV");
    return grid;
}

// Gives the voxels around active ones the mean of their active neighbours.
void extend(openvdb::Vec3SGrid& grid) {
    const openvdb::Vec3SGrid::Ptr before = grid.deepCopy();
    openvdb::tools::dilateActiveValues(grid.tree(), 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::PRESERVE_TILES);
    auto known = before->getConstAccessor();
    for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf)
        for (auto value = leaf->beginValueOn(); value; ++value) {
            const openvdb::Coord at = value.getCoord();
            if (known.isValueOn(at)) continue;
            openvdb::Vec3s sum(0);
            int count = 0;
            for (int i = 0; i < 27; ++i) {
                openvdb::Vec3s neighbour;
                if (!known.probeValue(at.offsetBy(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1), neighbour)) continue;
                sum += neighbour;
                ++count;
            }
            value.setValue(sum / static_cast<float>(std::max(count, 1)));
        }
}

struct Grids {
    openvdb::FloatGrid::Ptr density;
    openvdb::Vec3SGrid::Ptr colour;
};

Grids fill(const slice::Slice& volume, uint32_t depth) {
    const openvdb::math::Transform::Ptr transform = transform_of(volume, depth);
    const Grids grids{grid_of<openvdb::FloatGrid>("density", transform), grid_of<openvdb::Vec3SGrid>("Cd", transform)};
    grids.density->setGridClass(openvdb::GRID_FOG_VOLUME);
    auto density = grids.density->getAccessor();
    auto colour = grids.colour->getAccessor();
    for (const slice::Leaf& leaf : volume.leaves) {
        const voctree::LeafPosition at = voctree::position_of(leaf.cell >> 3 * (volume.depth - leaf.depth), leaf.depth);
        assert(leaf.depth <= depth);
        const int edge = 1 << (depth - leaf.depth);
        const glm::ivec3 cell = glm::ivec3(at.x, at.y, at.z) * edge;
        const openvdb::Coord first(cell.x, cell.y, cell.z);
        const float sigma = std::min(leaf.sigma, voctree::kMaxHalf);
        const openvdb::Vec3s shown = mean_colour(leaf, volume.degree);
        if (edge == 1) {
            density.setValue(first, sigma);
            colour.setValue(first, shown);
        } else {
            const auto box = openvdb::CoordBBox::createCube(first, edge);
            grids.density->tree().sparseFill(box, sigma, true);
            grids.colour->tree().sparseFill(box, shown, true);
            density.clear();
            colour.clear();
        }
    }
    extend(*grids.colour);
    return grids;
}

openvdb::FloatGrid::Ptr surface_of(const openvdb::FloatGrid& density, float level) {
    if (!density.hasUniformVoxels())
        throw InputError(Setting{"iso"}, "", "needs a clip whose cells are cubes", "leave it out");
    const double edge = density.voxelSize()[0];
    // By how much the opacity is less than the level.
    openvdb::FloatGrid clear(level);
    clear.setTransform(density.transform().copy());
    for (auto value = density.cbeginValueOn(); value; ++value) {
        const auto missing = static_cast<float>(double{level} + std::expm1(-double{*value} * edge));
        clear.tree().sparseFill(value.getBoundingBox(), missing, true);
    }
    openvdb::tools::dilateActiveValues(clear.tree(), 1, openvdb::tools::NN_FACE_EDGE_VERTEX,
                                       openvdb::tools::EXPAND_TILES);
    openvdb::FloatGrid::Ptr surface = openvdb::tools::levelSetRebuild(clear, 0.0f, kSurfaceVoxels);
    surface->setName("surface");
    surface->setCreator("NeuVV");
    return surface;
}

void turn(openvdb::GridBase& grid, const glm::dquat& rotation) {
    const glm::dmat3 r = glm::mat3_cast(rotation);
    const openvdb::math::Transform::Ptr turned = grid.transform().copy();
    turned->postMult(
        openvdb::Mat3d(r[0].x, r[0].y, r[0].z, r[1].x, r[1].y, r[1].z, r[2].x, r[2].y, r[2].z));  // of rows
    grid.setTransform(turned);
}

// The library's own function for files does not notice a full disk, and writes into the file itself.
class MemoryArchive : public openvdb::io::Archive {
  public:
    std::string write(const openvdb::GridCPtrVec& grids) const {
        std::ostringstream stream(std::ios::binary);
        Archive::write(stream, grids, true);
        return std::move(stream).str();
    }
};

}  // namespace

bool has_cubic_cells(const slice::Slice& volume) {
    const glm::dvec3 size(volume.box_size);
    const glm::dvec3 stretch = glm::abs(3.0 * size / (size.x + size.y + size.z) - 1.0);
    return std::max({stretch.x, stretch.y, stretch.z}) < double{kMostStretch};
}

std::string vdb_bytes(const slice::Slice& volume, const VdbOptions& options) {
    openvdb::initialize();
    const Grids grids = fill(volume, options.depth > 0 ? options.depth : slice::finest_depth(volume));
    std::vector<openvdb::GridBase::Ptr> all = {grids.density, grids.colour};
    if (options.surface_opacity) all.push_back(surface_of(*grids.density, *options.surface_opacity));
    if (options.rotation != glm::dquat(1, 0, 0, 0))
        for (const openvdb::GridBase::Ptr& grid : all) turn(*grid, options.rotation);
    const glm::dvec3& origin = options.origin;
    if (origin != glm::dvec3(0))
        for (const openvdb::GridBase::Ptr& grid : all) {
            const openvdb::math::Transform::Ptr moved = grid->transform().copy();
            moved->postTranslate({origin.x, origin.y, origin.z});
            grid->setTransform(moved);
        }
    return MemoryArchive().write({all.begin(), all.end()});
}

void write_vdb(const std::filesystem::path& file, const slice::Slice& volume, const VdbOptions& options) {
    const std::string bytes = vdb_bytes(volume, options);
    write_file_atomically(file, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

}  // namespace neuvv::interchange
