#include "interchange/volume/vdb_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/platform.h"
#include "base/threads/parallel.h"
#include "interchange/volume/still_tree.h"
#include "interchange/volume/vdb_choice.h"
#include "voctree/coarse.h"

namespace neuvv::interchange {

namespace {

constexpr std::array<int, 3> kTileEdges = {kVdbBlockEdge, 128, 4096};
constexpr const char* kSmallerVolume = "crop it, or make its voxels larger";
constexpr size_t kBytesOfLeaf = 120;  // of memory, while a tree is made
constexpr double kLeastTransmittance = 1e-3, kVoxelsAStep = 0.5, kLeastParallel = 0.999999;

// Tells cubes of this edge apart.
uint64_t key_of(const glm::ivec3& index, int edge) {
    uint64_t key = 0;
    for (int i = 0; i < 3; ++i)
        key = key << 21 | static_cast<uint64_t>(((index[i] & ~(edge - 1)) + kMostVdbIndex) / kVdbBlockEdge);
    return key;
}

// How indices of a grid become cells whose axes are the world's: cell[a] = sign[a] · index[from[a]].
struct Axes {
    std::array<int, 3> from{};
    glm::ivec3 sign{1};
    glm::dvec3 edge_m{1}, centre_m{0};  // of a cell, and of the cell 0

    glm::ivec3 cell(const glm::ivec3& index) const {
        glm::ivec3 cell;
        for (size_t a = 0; a < 3; ++a) cell[static_cast<int>(a)] = sign[static_cast<int>(a)] * index[from[a]];
        return cell;
    }
};

Axes axes_of(const VdbVolume& volume) {
    const glm::dmat4 m = volume.world_from_file * volume.density.world_from_index;
    Axes axes;
    axes.centre_m = glm::dvec3(m[3]);
    std::array<bool, 3> taken{};
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 column(m[i]), sizes = glm::abs(column);
        const int a = sizes.x > sizes.y && sizes.x > sizes.z ? 0 : sizes.y > sizes.z ? 1 : 2;
        if (taken[static_cast<size_t>(a)] || sizes[a] < kLeastParallel * glm::length(column))
            throw InputError(volume.file, volume.density.name, "has voxels that do not lie along the axes",
                             "resample it to a grid that is not turned");
        taken[static_cast<size_t>(a)] = true;
        axes.from[static_cast<size_t>(a)] = i;
        axes.sign[a] = column[a] < 0 ? -1 : 1;
        axes.edge_m[a] = sizes[a];
    }
    return axes;
}

double metres_a_unit(const VdbVolume& volume) {
    return glm::length(glm::dvec3(volume.world_from_file[0]));
}

// Calls add(first index, edge, value) for every active voxel and tile that has a density.
template <typename Add>
void for_dense(const VdbGrid& grid, const Add& add) {
    for (const VdbTile& tile : grid.tiles)
        if (*grid.value(tile.first) > 0) add(tile.min, tile.edge, *grid.value(tile.first));
    for (const VdbBlock& block : grid.blocks) {
        size_t next = block.first;
        for (int x = 0; x < kVdbBlockEdge; ++x)
            for (uint64_t left = block.active[static_cast<size_t>(x)]; left != 0; left &= left - 1) {
                const int bit = std::countr_zero(left);
                const float value = *grid.value(next++);
                if (value > 0) add(block.min + glm::ivec3(x, bit / 8, bit % 8), 1, value);
            }
    }
}

struct CellRange {
    glm::ivec3 low{std::numeric_limits<int>::max()}, high{std::numeric_limits<int>::min()};
};

// Of the cells that have a density; low > high where there are none.
CellRange range_of(const VdbVolume& volume, const Axes& axes) {
    CellRange range;
    for_dense(volume.density, [&](const glm::ivec3& first, int edge, float) {
        for (const glm::ivec3& index : {first, first + (edge - 1)}) {
            range.low = glm::min(range.low, axes.cell(index));
            range.high = glm::max(range.high, axes.cell(index));
        }
    });
    return range;
}

// The value at an index that may be anything, even no number.
const float* nearest(VdbLookup& lookup, const glm::dvec3& index) {
    if (!glm::all(glm::lessThanEqual(glm::abs(index), glm::dvec3(kMostVdbIndex)))) return nullptr;
    return lookup.at(glm::round(index));
}

// Makes leaves of cubes of cells.
class LeafMaker {
  public:
    LeafMaker(const VdbVolume& volume, const Axes& axes, const CellBox& box)
        : volume_(volume), axes_(axes), box_(box), most_leaves_(available_memory_bytes() / 2 / kBytesOfLeaf) {
        if (!volume.colour) return;
        colours_.emplace(*volume.colour);
        colour_from_density_ = glm::inverse(volume.colour->world_from_index) * volume.density.world_from_index;
    }
    // A cube of cells of one value, `low` its first one in the box. `index`: one of its voxels.
    void add(const glm::ivec3& low, int edge, const glm::ivec3& index, float sigma) {
        add_cell({0, 0, 0, 0}, low, low + edge, value_of(index, sigma));
    }
    StillLeaves leaves;

  private:
    using Value = std::array<float, 4>;
    Value value_of(const glm::ivec3& index, float sigma) {
        const float* colour = nullptr;
        if (colours_) colour = nearest(*colours_, colour_from_density_ * glm::dvec4(index, 1));
        Value value{sigma};
        for (size_t c = 0; c < 3; ++c) value[c + 1] = constant_harmonic(colour ? colour[c] : 1);
        return value;
    }
    // The part of a tree's cell that lies between `low` and `high`, which is not part of the cube.
    void add_cell(const voctree::LeafPosition& at, const glm::ivec3& low, const glm::ivec3& high, const Value& value) {
        const int size = 1 << (box_.depth - at.depth);
        const glm::ivec3 begin = glm::ivec3(at.x, at.y, at.z) * size, end = begin + size;
        if (glm::any(glm::greaterThanEqual(begin, high)) || glm::any(glm::lessThanEqual(end, low))) return;
        if (at.depth > 0 && glm::all(glm::greaterThanEqual(begin, low)) && glm::all(glm::lessThanEqual(end, high))) {
            const double edge_m = (axes_.edge_m.x + axes_.edge_m.y + axes_.edge_m.z) / 3 * size;
            if (-std::expm1(-double{value[0]} * edge_m) < double{kLeastImportedOpacity}) return;
            if (leaves.positions.size() >= std::min<size_t>(most_leaves_, voctree::kMaxLeaves))
                throw InputError(volume_.file, volume_.density.name, "has more voxels than there is memory for",
                                 kSmallerVolume);
            leaves.positions.push_back(at);
            leaves.values.insert(leaves.values.end(), value.begin(), value.end());
            return;
        }
        for (uint32_t i = 0; i < 8; ++i)
            add_cell({2 * at.x + (i & 1), 2 * at.y + (i >> 1 & 1), 2 * at.z + (i >> 2), at.depth + 1}, low, high,
                     value);
    }

    const VdbVolume& volume_;
    const Axes& axes_;
    const CellBox& box_;
    size_t most_leaves_;
    std::optional<VdbLookup> colours_;
    glm::dmat4 colour_from_density_{1};
};

// What a ray sees at a point of the file.
class Sampler {
  public:
    explicit Sampler(const VdbVolume& volume) : density_(volume.density) {
        index_from_world_ = glm::inverse(volume.world_from_file * volume.density.world_from_index);
        if (!volume.colour) return;
        colour_.emplace(*volume.colour);
        colour_from_density_ = glm::inverse(volume.colour->world_from_index) * volume.density.world_from_index;
    }
    const glm::dmat4& index_from_world() const { return index_from_world_; }
    // The density, in `w` and the colour times that, interpolated between eight voxels.
    glm::dvec4 at(const glm::dvec3& index) {
        const glm::dvec3 base = glm::floor(index), share = index - base;
        glm::dvec4 sum(0);
        for (int i = 0; i < 8; ++i) {
            const glm::ivec3 corner(i & 1, i >> 1 & 1, i >> 2), voxel = glm::ivec3(base) + corner;
            const float* density = density_.at(voxel);
            if (!density || !(*density > 0)) continue;
            const glm::dvec3 part = glm::mix(1.0 - share, share, glm::dvec3(corner));
            const float* colour = nullptr;
            if (colour_) colour = nearest(*colour_, colour_from_density_ * glm::dvec4(voxel, 1));
            const glm::dvec3 rgb =
                colour ? glm::clamp(glm::dvec3(colour[0], colour[1], colour[2]), 0.0, 1.0) : glm::dvec3(1);
            sum += part.x * part.y * part.z * double{*density} * glm::dvec4(rgb, 1);
        }
        return sum;
    }

  private:
    VdbLookup density_;
    std::optional<VdbLookup> colour_;
    glm::dmat4 index_from_world_, colour_from_density_{1};
};

// Where a ray is in a box; far < near where it misses.
struct Span {
    double near, far;
};
Span span_in(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& low, const glm::dvec3& high) {
    Span span{0, std::numeric_limits<double>::max()};
    for (int i = 0; i < 3; ++i) {
        const double a = (low[i] - origin[i]) / direction[i], b = (high[i] - origin[i]) / direction[i];
        if (std::isnan(a) || std::isnan(b)) continue;  // along a face
        span = {std::max(span.near, std::min(a, b)), std::min(span.far, std::max(a, b))};
    }
    return span;
}

}  // namespace

VdbLookup::VdbLookup(const VdbGrid& grid) : grid_(grid) {
    for (const VdbBlock& block : grid.blocks) blocks_.emplace(key_of(block.min, kVdbBlockEdge), &block);
    for (const VdbTile& tile : grid.tiles) {
        const auto size = std::find(kTileEdges.begin(), kTileEdges.end(), tile.edge) - kTileEdges.begin();
        tiles_[static_cast<size_t>(size)].emplace(key_of(tile.min, tile.edge), &tile);
    }
}

const float* VdbLookup::at(const glm::ivec3& index) {
    if (glm::any(glm::lessThan(index, glm::ivec3(-kMostVdbIndex))) ||
        glm::any(glm::greaterThanEqual(index, glm::ivec3(kMostVdbIndex))))
        return nullptr;
    const uint64_t key = key_of(index, kVdbBlockEdge);
    if (key != last_) {
        last_ = key;
        const auto block = blocks_.find(key);
        last_block_ = block == blocks_.end() ? nullptr : block->second;
        last_tile_ = nullptr;
        for (size_t i = 0; i < kTileEdges.size() && !last_block_ && !last_tile_; ++i) {
            const auto tile = tiles_[i].find(key_of(index, kTileEdges[i]));
            if (tile != tiles_[i].end()) last_tile_ = tile->second;
        }
    }
    if (last_tile_) return grid_.value(last_tile_->first);
    if (!last_block_) return nullptr;
    const glm::ivec3 in = index - last_block_->min;
    const int bit = 8 * in.y + in.z;
    if (!(last_block_->active[static_cast<size_t>(in.x)] >> bit & 1)) return nullptr;
    size_t before =
        static_cast<size_t>(std::popcount(last_block_->active[static_cast<size_t>(in.x)] & ((uint64_t{1} << bit) - 1)));
    for (size_t x = 0; x < static_cast<size_t>(in.x); ++x)
        before += static_cast<size_t>(std::popcount(last_block_->active[x]));
    return grid_.value(last_block_->first + before);
}

VdbVolume volume_of(std::vector<VdbGrid> grids, const std::string& file, const glm::dmat4& world_from_file) {
    VdbVolume volume{file, {}, {}, world_from_file, {}};
    VdbChoice choice = choose_grids(grids, file);
    volume.density = std::move(grids[choice.density]);
    if (choice.colour) volume.colour = std::move(grids[*choice.colour]);
    volume.notes = std::move(choice.notes);
    axes_of(volume);  // throws
    return volume;
}

std::optional<uint32_t> doublings_for(const VdbVolume& volume, uint32_t resolution) {
    const CellRange range = range_of(volume, axes_of(volume));
    if (range.low.x > range.high.x) return std::nullopt;
    int longest = 1;
    for (int i = 0; i < 3; ++i) longest = std::max(longest, range.high[i] - range.low[i] + 1);
    uint32_t doublings = 0;
    while (longest > static_cast<int>(resolution << doublings)) ++doublings;
    return doublings;
}

voctree::VOctree tree_of(const VdbVolume& volume, uint32_t doublings, float fps) {
    const Axes axes = axes_of(volume);
    CellRange range = range_of(volume, axes);
    if (range.low.x > range.high.x) range = {glm::ivec3(0), glm::ivec3(0)};
    const CellBox box = CellBox::around(range.low, range.high, kVdbBlockEdge << doublings, volume.file, kSmallerVolume);
    LeafMaker maker(volume, axes, box);
    const double scale = metres_a_unit(volume);
    for_dense(volume.density, [&](const glm::ivec3& first, int edge, float density) {
        const glm::ivec3 low = glm::min(axes.cell(first), axes.cell(first + (edge - 1)));
        maker.add(low - box.first, edge, first, static_cast<float>(double{density} / scale));
    });
    const voctree::VOctree tree = still_tree(maker.leaves, box, axes.centre_m - 0.5 * axes.edge_m, axes.edge_m, fps);
    return doublings > 0 ? voctree::cut_tree(tree, std::max(box.depth, doublings + 1) - doublings) : tree;
}

media::Image vdb_image(const VdbVolume& volume, const stage::Camera& camera, const std::function<void()>& between,
                       const glm::vec3& background) {
    const Axes axes = axes_of(volume);
    glm::dvec3 low(1), high(0);  // indices, with what is interpolated around them
    if (const CellRange range = range_of(volume, axes); range.low.x <= range.high.x) {
        for (size_t a = 0; a < 3; ++a) {
            const int i = static_cast<int>(a), to = axes.from[a];
            low[to] = (axes.sign[i] > 0 ? range.low[i] : -range.high[i]) - 1;
            high[to] = (axes.sign[i] > 0 ? range.high[i] : -range.low[i]) + 1;
        }
    }
    const double scale = metres_a_unit(volume);
    media::Image image(camera.width, camera.height);
    parallel_for(camera.height, 8, [&](size_t begin, size_t end) {
        Sampler sampler(volume);
        const glm::dvec3 eye(sampler.index_from_world() * camera.world_from_camera[3]);
        for (size_t y = begin; y < end; ++y) {
            between();
            for (uint32_t x = 0; x < camera.width; ++x) {
                const glm::dvec3 in_camera((x + 0.5 - camera.cx) / camera.fx,
                                           (camera.cy - static_cast<double>(y) - 0.5) / camera.fy, -1);
                const glm::dvec3 world = glm::dmat3(camera.world_from_camera) * glm::normalize(in_camera);
                const glm::dvec3 along = glm::dmat3(sampler.index_from_world()) * world;  // indices a metre
                const double step_m = kVoxelsAStep / glm::length(along), step_of_file = step_m / scale;
                glm::dvec3 seen(0);
                double transmittance = 1;
                const Span span = span_in(eye, along, low, high);
                for (double t = span.near + 0.5 * step_m; t < span.far && transmittance > kLeastTransmittance;
                     t += step_m) {
                    const glm::dvec4 sample = sampler.at(eye + t * along);
                    if (!(sample.w > 0)) continue;
                    const double left = transmittance * std::exp(-sample.w * step_of_file);
                    seen += (transmittance - left) / sample.w * glm::dvec3(sample);
                    transmittance = left;
                }
                uint8_t* to = image.at(x, static_cast<uint32_t>(y));
                for (int c = 0; c < 3; ++c)
                    to[c] = static_cast<uint8_t>(std::lround(
                        255 * media::srgb_from_linear(std::min(1.0, seen[c] + transmittance * double{background[c]}))));
                to[3] = 255;
            }
        }
    });
    return image;
}

}  // namespace neuvv::interchange
