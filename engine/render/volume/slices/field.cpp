#include "render/volume/slices/field.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "gpu/host_copies.h"
#include "render/volume/slices/slice_tree.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

constexpr size_t kCachedLeaves = 256;  // whose weights fit in a core's cache

// Calls visit(index among the leaf's weights, plane, component of the texel) for every weight of a leaf.
void for_each_weight(const voctree::VOctree& tree, const std::function<void(uint32_t, uint32_t, uint32_t)>& visit) {
    const uint32_t basis_planes = (tree.bases + 3) / 4, functions = hh_count(tree.hh_degree);
    for (uint32_t kind = 0; kind < 2; ++kind)
        for (uint32_t c = 0; c < tree.bases; ++c) visit(kind * tree.bases + c, kind * basis_planes + c / 4, c % 4);
    for (uint32_t channel = 0; channel < 3; ++channel)
        for (uint32_t f = 0; f < functions; ++f)
            visit(2 * tree.bases + channel * functions + f, 2 * basis_planes + f, channel);
}

size_t plane_floats(const voctree::VOctree& tree) {
    return size_t{4} * tree.leaf_count * (2 * ((tree.bases + 3) / 4) + hh_count(tree.hh_degree));
}

// The weights of all leaves by planes, each number converted.
template <typename Number, typename Convert>
std::vector<Number> planes_of(const voctree::VOctree& tree, const Convert& convert) {
    std::vector<Number> planes(plane_floats(tree));
    const uint32_t stride = tree.weights_per_leaf();
    parallel_for(tree.leaf_count, kCachedLeaves, [&](size_t begin, size_t end) {
        for_each_weight(tree, [&](uint32_t index, uint32_t plane, uint32_t component) {
            Number* to = &planes[size_t{4} * plane * tree.leaf_count + component];
            for (size_t leaf = begin; leaf < end; ++leaf) to[4 * leaf] = convert(tree.weights[leaf * stride + index]);
        });
    });
    return planes;
}

// The largest number of planes that are not 0 at any time. Between two frames their rows are mixed, so two neighbouring
// rows count together.
uint32_t count_busy_planes(const std::vector<float>& basis, uint32_t frames, uint32_t bases) {
    uint32_t max = 1;
    for (uint32_t t = 0; t < frames; ++t) {
        const uint32_t rows = std::min(2u, frames - t);
        uint32_t busy = 0;
        for (uint32_t plane = 0; plane < bases; plane += 4) {
            bool any = false;
            for (uint32_t row = t; row < t + rows; ++row)
                for (uint32_t c = plane; c < std::min(plane + 4, bases); ++c)
                    any |= basis[size_t{row} * bases + c] != 0;
            busy += any ? 1 : 0;
        }
        max = std::max(max, busy);
    }
    return max;
}

// The mean edge of the leaves, as a fraction of the edge of the box that the tree was given.
float mean_edge(const LeavesOfDepth& leaves) {
    double sum = 0, count = 0;
    for (size_t depth = 1; depth < leaves.size(); ++depth) {
        sum += std::ldexp(leaves[depth], -static_cast<int>(depth));
        count += leaves[depth];
    }
    return count == 0 ? 0 : static_cast<float>(sum / count);
}

// Creates the buffers of the weights, and adds their uploads.
void add_weights(Field& field, const std::vector<uint16_t>& halves, gpu::Uploads& uploads, const gpu::Device& device) {
    const gpu::BufferLimits& limits = device.buffers();
    const uint32_t planes = field.planes();
    const uint64_t plane_bytes = uint64_t{8} * field.leaf_count;
    field.weights_by_address = limits.profile == gpu::BufferProfile::kStorage &&
                               planes * plane_bytes > std::min(limits.storage_bytes, device.max_allocation_bytes());
    if (limits.profile == gpu::BufferProfile::kTexel && planes * uint64_t{field.leaf_count} > limits.texels &&
        limits.allow_storage())
        throw RuntimeFailure(fmt::format("the weights of {} leaves are more than device \"{}\" binds as a texel buffer",
                                         field.leaf_count, device.summary().name),
                             Remedy::kFewerLeavesOrStorage);
    if (!field.weights_by_address) {
        field.weights.push_back(uploads.add("leaf weights (fp16)", halves, VK_FORMAT_R16G16B16A16_SFLOAT));
        return;
    }
    uint32_t& log2 = field.part_planes_log2;
    log2 = static_cast<uint32_t>(std::bit_width(planes - 1));
    const auto parts = [&] { return ((planes - 1) >> log2) + 1; };
    while (log2 > 0 && std::min(planes, 1u << log2) * plane_bytes > device.max_allocation_bytes() &&
           2 * parts() <= kMostWeightParts)
        --log2;
    for (uint32_t i = 0; i < parts(); ++i) {
        const uint32_t first = i << log2;
        const uint64_t bytes = std::min(planes - first, 1u << log2) * plane_bytes;
        field.weights.emplace_back(device, "leaf weights (fp16)", bytes, gpu::MemoryKind::kDevice);
        uploads.add(field.weights.back(), halves.data() + first * plane_bytes / sizeof(uint16_t), bytes);
    }
}

}  // namespace

void set_shape(Field& field, const WalkShape& shape, glm::vec3 box_size) {
    field.box_size = box_size * static_cast<float>(shape.scale);
    field.node_levels = shape.node_levels;
    field.top_levels = shape.top.levels;
    field.levels_above = shape.scale - 1;  // the scale is 1 or 2
    field.level_begin = shape.level_begin;
    const auto& [low, last] = shape.top.bounds;
    field.top_box = top_box(shape.top.bounds);
    const glm::vec3 top_cell = field.box_size / std::exp2(2.0f * static_cast<float>(shape.top.levels));
    field.leaves_min = field.box_min + glm::vec3(low) * top_cell;
    field.leaves_max = field.box_min + glm::vec3(last + 1u) * top_cell;
    field.leaf_diagonal = glm::length(box_size) * mean_edge(shape.leaves);
    bool any = false;
    for (uint32_t depth = 1; depth < shape.leaves.size(); ++depth) {
        if (shape.leaves[depth] == 0) continue;
        if (!std::exchange(any, true)) field.coarsest_level = depth;
        field.finest_level = depth;
    }
}

uint64_t device_bytes(const Field& field) {
    uint64_t bytes = 0;
    for (const gpu::Buffer& part : field.weights) bytes += part.bytes;
    for (const gpu::Buffer* buffer :
         {&field.nodes, &field.sigma_basis, &field.gamma_basis, &field.links, &field.leaf_cells, &field.node_cells,
          &field.leaf_positions, &field.node_positions})
        bytes += buffer->bytes;
    if (field.slice)
        for (const gpu::Buffer* buffer : {&field.slice->nodes, &field.slice->entries, &field.slice->entry_leaf})
            bytes += buffer->bytes;
    for (const Field& coarser : field.coarser) bytes += device_bytes(coarser);
    return bytes;
}

std::vector<float> weights_to_planes(const voctree::VOctree& tree) {
    return planes_of<float>(tree, [](float weight) { return weight; });
}

void weights_from_planes(const std::vector<float>& planes, voctree::VOctree& tree) {
    const uint32_t stride = tree.weights_per_leaf();
    tree.weights.resize(size_t{tree.leaf_count} * stride);
    parallel_for(tree.leaf_count, kCachedLeaves, [&](size_t begin, size_t end) {
        for_each_weight(tree, [&](uint32_t index, uint32_t plane, uint32_t component) {
            const float* from = &planes[size_t{4} * plane * tree.leaf_count + component];
            for (size_t leaf = begin; leaf < end; ++leaf) tree.weights[leaf * stride + index] = from[4 * leaf];
        });
    });
}

Field upload_field(const gpu::Device& device, const voctree::VOctree& tree, WeightPrecision precision) {
    const TraceSpan span("upload a field");
    Field field;
    field.box_min = tree.box_min;
    field.leaf_count = tree.leaf_count;
    field.bases = tree.bases;
    field.hh_degree = tree.hh_degree;
    field.frames = tree.frames;
    field.half_weights = precision == WeightPrecision::kHalf;
    field.has_srgb_colours = tree.has_srgb_colours;
    field.busy_planes = std::max(count_busy_planes(tree.sigma_basis, tree.frames, tree.bases),
                                 count_busy_planes(tree.gamma_basis, tree.frames, tree.bases));
    WalkTree walk = [&] {
        const TraceSpan span_of_tree("make the tree that shaders walk");
        return walk_tree(tree);
    }();
    set_shape(field, walk, tree.box_size);
    gpu::Uploads uploads(device);
    // One array each where shaders read both, as some devices bind only 8 storage buffers.
    for (TreeNode& node : walk.nodes) node.first_child += static_cast<uint32_t>(walk.top.cells.size());
    walk.top.cells.insert(walk.top.cells.end(), walk.children.begin(), walk.children.end());
    walk.inner_cells.insert(walk.inner_cells.end(), walk.node_cells.begin(), walk.node_cells.end());
    field.nodes = uploads.add("tree nodes", walk.nodes, VK_FORMAT_R32G32B32A32_UINT);
    field.links = uploads.add("tree links", walk.top.cells, VK_FORMAT_R32_UINT);
    field.leaf_cells = uploads.add("leaf cells", walk.leaf_cells, VK_FORMAT_R32G32_UINT);
    field.node_cells = uploads.add("node cells", walk.inner_cells, VK_FORMAT_R32G32_UINT);
    field.leaf_positions = uploads.add("leaf positions", walk.leaf_positions, VK_FORMAT_R32G32_UINT);
    field.node_positions = uploads.add("node positions", walk.node_positions, VK_FORMAT_R32G32_UINT);
    field.sigma_basis = uploads.add("basis A", tree.sigma_basis, VK_FORMAT_R32_SFLOAT);
    field.gamma_basis = uploads.add("basis B", tree.gamma_basis, VK_FORMAT_R32_SFLOAT);
    std::vector<float> floats;
    std::vector<uint16_t> halves;
    if (precision == WeightPrecision::kFloat) {
        floats = weights_to_planes(tree);
        field.weights.push_back(uploads.add("leaf weights", floats, VK_FORMAT_R32G32B32A32_SFLOAT));
    } else {
        halves = planes_of<uint16_t>(tree, [](float weight) { return voctree::half_from_float(weight); });
        add_weights(field, halves, uploads, device);
    }
    uploads.finish();
    return field;
}

}  // namespace neuvv::render
