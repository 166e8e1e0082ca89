#include "interchange/mesh/bake.h"

#include <algorithm>
#include <cmath>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "voctree/sh_weights.h"

namespace neuvv::interchange {

namespace {

constexpr float kBefore = 2, kBehind = 6, kStep = 0.25f;  // cells
constexpr float kLeastSeen = 1e-3f;
// The mean of harmonics of each degree over a hemisphere, weighted by the cosine with its axis, relative to their value
// there (Ramamoorthi and Hanrahan, "An efficient representation for irradiance environment maps", 2001).
constexpr std::array<double, 4> kMeanOfDegree = {1, 2.0 / 3, 0.25, 0};

std::array<float, kMaxShCount> mean_basis(const glm::vec3& direction) {
    const std::array<double, kMaxShCount> at = voctree::sh_basis(glm::dvec3(direction));
    std::array<float, kMaxShCount> mean{};
    for (size_t l = 0; l <= 3; ++l)
        for (size_t i = l * l; i < (l + 1) * (l + 1); ++i) mean[i] = static_cast<float>(kMeanOfDegree[l] * at[i]);
    return mean;
}

glm::vec3 colour_of(const slice::Leaf& leaf, uint32_t degree, const std::array<float, kMaxShCount>& basis) {
    glm::vec3 colour;
    for (int c = 0; c < 3; ++c) {
        float logit = 0;
        for (size_t i = 0; i < sh_count(degree); ++i) logit += leaf.colours[static_cast<size_t>(c)][i] * basis[i];
        colour[c] = sigmoid(logit);
    }
    return colour;
}

// Linear light and its weight, 1 or 0: whether there is anything.
glm::vec4 seen_at(const LeafGrid& grid, const glm::vec3& point, const glm::vec3& normal) {
    const std::array<float, kMaxShCount> basis = mean_basis(-normal);
    const float cell = std::min({grid.cell_m().x, grid.cell_m().y, grid.cell_m().z}), step = kStep * cell;
    glm::vec3 sum(0);
    float transmittance = 1;
    const slice::Leaf* last = nullptr;
    glm::vec3 colour(0);
    for (float at = kBefore * cell; at > -kBehind * cell && transmittance > kLeastSeen; at -= step) {
        const slice::Leaf* leaf = grid.leaf_at(point + at * normal);
        if (leaf == nullptr) continue;
        if (leaf != last) colour = colour_of(*leaf, grid.volume().degree, basis);
        last = leaf;
        const float left = transmittance * std::exp(-leaf->sigma * step);
        sum += (transmittance - left) * colour;
        transmittance = left;
    }
    const float opacity = 1 - transmittance;
    return opacity > kLeastSeen ? glm::vec4(sum / opacity, 1) : glm::vec4(0);
}

// Gives all colours of weight 0 those of their surroundings: ever smaller images have means of what is known, and are
// read where the larger ones know nothing.
void fill_unknown(std::vector<glm::vec4>& colours, uint32_t side) {
    std::vector<glm::vec4> half;
    const uint32_t half_side = (side + 1) / 2;
    if (side > 1) {
        half.resize(size_t{half_side} * half_side, glm::vec4(0));
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                half[size_t{y / 2} * half_side + x / 2] += colours[size_t{y} * side + x];
        for (glm::vec4& colour : half)
            if (colour.w > 0) colour /= colour.w;
        fill_unknown(half, half_side);
    }
    for (uint32_t y = 0; y < side; ++y)
        for (uint32_t x = 0; x < side; ++x)
            if (glm::vec4& colour = colours[size_t{y} * side + x]; !(colour.w > 0) && side > 1)
                colour = half[size_t{y / 2} * half_side + x / 2];
}

std::array<uint8_t, 3> bytes_of(const glm::vec4& linear) {
    return {media::srgb_byte_from_linear(linear.x), media::srgb_byte_from_linear(linear.y),
            media::srgb_byte_from_linear(linear.z)};
}

}  // namespace

std::vector<std::array<uint8_t, 3>> vertex_colours(const LeafGrid& grid, const TriangleMesh& mesh) {
    const std::vector<glm::vec3> normals = normals_of(mesh);
    std::vector<glm::vec4> seen(normals.size());
    parallel_for(seen.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) seen[i] = seen_at(grid, mesh.positions[i], normals[i]);
    });
    glm::vec4 mean(0);
    for (const glm::vec4& colour : seen) mean += colour;
    mean /= std::max(mean.w, 1.0f);
    std::vector<std::array<uint8_t, 3>> colours;
    for (const glm::vec4& colour : seen) colours.push_back(bytes_of(colour.w > 0 ? colour : mean));
    return colours;
}

media::Image baked_texture(const LeafGrid& grid, const MappedMesh& mesh, uint32_t side_px,
                           const std::function<void()>& between) {
    const std::vector<Texel> texels = texels_of(mesh, side_px);
    std::vector<glm::vec4> seen(texels.size(), glm::vec4(0));
    constexpr uint32_t kRows = 64;
    for (uint32_t first = 0; first < side_px; first += kRows) {
        between();
        parallel_for(std::min(kRows, side_px - first), 4, [&](size_t begin, size_t end) {
            for (size_t i = (first + begin) * side_px; i < (first + end) * side_px; ++i) {
                if (texels[i].triangle == UINT32_MAX) continue;
                const glm::uvec3& triangle = mesh.triangles[texels[i].triangle];
                const glm::vec3 weights(texels[i].at, 1 - texels[i].at.x - texels[i].at.y);
                glm::vec3 point(0), normal(0);
                for (int k = 0; k < 3; ++k) {
                    point += weights[k] * mesh.positions[triangle[k]];
                    normal += weights[k] * mesh.normals[triangle[k]];
                }
                const float length = glm::length(normal);
                seen[i] = seen_at(grid, point, length > 0 ? normal / length : glm::vec3(0, 1, 0));
            }
        });
    }
    fill_unknown(seen, side_px);
    media::Image image(side_px, side_px);
    for (size_t i = 0; i < seen.size(); ++i) {
        const std::array<uint8_t, 3> bytes = bytes_of(seen[i]);
        std::copy(bytes.begin(), bytes.end(), &image.rgba[4 * i]);
        image.rgba[4 * i + 3] = 255;
    }
    return image;
}

}  // namespace neuvv::interchange
