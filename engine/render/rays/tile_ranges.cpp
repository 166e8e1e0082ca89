#include "render/rays/tile_ranges.h"

#include <algorithm>

#include "render/rays/ray_grid.h"

namespace neuvv::render {

namespace {

// A dispatch over a list rounds the number of tiles up to whole rows.
uint64_t list_bytes(uint32_t tiles) {
    return uint64_t{4} * tiles + uint64_t{4} * kListRow;
}

}  // namespace

RangeView range_view(const ShaderCamera& camera) {
    // The pixel (x, y) shows the points p with p − eye = z (corner + x·right + y·down).
    const glm::dmat3 place_from_pixel{glm::dvec3(camera.right), glm::dvec3(camera.down), glm::dvec3(camera.corner)};
    const glm::dmat3 rows = glm::transpose(glm::inverse(place_from_pixel));
    const auto row = [&rows](int i) { return glm::vec4(glm::vec3(rows[i]), 0); };
    double longest_m = 0;  // the vector of a pixel is linear in x and y, so the longest one is at a corner
    for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(1, 1)}) {
        const glm::dvec2 at = corner * glm::dvec2(pixel_of_ray(camera.across, camera.right.w),
                                                  pixel_of_ray(camera.downwards, camera.down.w));
        longest_m = std::max(longest_m, glm::length(place_from_pixel * glm::dvec3(at, 1)));
    }
    return {glm::vec4(glm::vec3(camera.origin), static_cast<float>(longest_m)),
            row(0),
            row(1),
            row(2),
            camera.across,
            camera.downwards};
}

double pixels_covered(const RangeView& view, glm::dvec2 image, glm::vec3 box_min, glm::vec3 box_max) {
    glm::dvec2 low(1e30), high(-1e30);
    uint32_t behind = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const glm::bvec3 upper(i & 1, i & 2, i & 4);
        const glm::dvec3 from_eye(glm::mix(box_min, box_max, upper) - glm::vec3(view.eye));
        const auto along = [&](glm::vec4 row) { return glm::dot(glm::dvec3(row), from_eye); };
        const double z = along(view.row_z);
        behind += z <= 0;
        const glm::dvec2 pixel = glm::dvec2(along(view.row_x), along(view.row_y)) / z;
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    if (behind == 8) return 0;
    if (behind > 0) return image.x * image.y;
    const glm::dvec2 covered = glm::max(glm::min(high, image) - glm::max(low, 0.0), 0.0);
    return covered.x * covered.y;
}

TileRanges::TileRanges(const gpu::Device& device, uint32_t ray_tiles, uint32_t image_tiles, uint32_t cameras,
                       gpu::MemoryKind views_in)
    : image_tile_capacity(image_tiles),
      views(device, "views of instances", sizeof(RangeView) * uint64_t{cameras}, views_in),
      ranges(device, "tile ranges", uint64_t{8} * ray_tiles, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      list(device, "tile list", list_bytes(ray_tiles), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      count(device, "count of tiles", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      covered(device, "covered tiles", uint64_t{4} * ray_tiles, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      sharing(device, "shared tiles", uint64_t{4} * ray_tiles, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      image_list(device, "images' tile list", list_bytes(image_tiles), gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      image_count(device, "count of the images' tiles", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      image_shown(device, "shown tiles of images", uint64_t{4} * image_tiles, gpu::MemoryKind::kDevice,
                  VK_FORMAT_R32_UINT) {}

void record_clear_coverage(gpu::Commands& commands, const TileRanges& ranges) {
    gpu::fill(commands, ranges.covered, 0);
    gpu::compute_barrier(commands);
}

void record_empty_list(gpu::Commands& commands, const gpu::Buffer& list, const gpu::Buffer& count, uint32_t tiles) {
    gpu::fill(commands, list, kNoTile, list_bytes(tiles));
    gpu::update(commands, count, LiveCount{0, 1, 1, 0, 0});
    gpu::compute_barrier(commands);
}

void record_clear_sharing(gpu::Commands& commands, const TileRanges& ranges) {
    gpu::fill(commands, ranges.sharing, 0);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
