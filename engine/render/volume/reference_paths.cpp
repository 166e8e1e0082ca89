#include "render/volume/reference_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>

#include "base/error.h"

namespace neuvv::render {

ReferenceRenderer::SlotPath::SlotPath(const gpu::Device& device, const Field& field, const RayBatch& rays)
    : slice(device, field, field.leaf_count), slicer(device, field, slice), tracer(device, field, slice, rays) {}

ReferenceRenderer::DirectPath::DirectPath(const gpu::Device& device, const Field& field, const RayBatch& rays)
    : live(device, field, 1),
      finder(device, field, live),
      direct(device, field, live, rays),
      paper(device, field, live, rays, Walk::kFromRoot) {}

ReferenceRenderer::ReferenceRenderer(const gpu::Device& device, const Field& field, uint32_t width, uint32_t height,
                                     uint32_t samples)
    : device_(device),
      field_(field),
      rays_(device, 1, checked_ray_tiles(device, {width, height, samples})),
      image_(device, "reference image", ViewLayout{width, height}.image_bytes(), gpu::MemoryKind::kDevice,
             VK_FORMAT_R32_UINT),
      readback_(device, "reference image readback", image_.bytes, gpu::MemoryKind::kReadback),
      resolver_(device, RaysPerPixel::kWhole, rays_, image_),
      commands_(device, "reference frame") {}

void ReferenceRenderer::prepare(const stage::Camera& camera, const ReferenceSettings& settings) {
    assert(!is_inspection(settings.resolve.show));
    layout_ = {camera.width, camera.height, settings.samples};
    if (layout_.ray_tiles() > rays_.tile_capacity || layout_.image_bytes() > image_.bytes)
        throw RuntimeFailure(
            fmt::format("an image of {}x{} is more than its renderer was made for", camera.width, camera.height));
    *rays_.cameras.as<ShaderCamera>() = shader_camera(stage::enlarged(camera, settings.samples), settings.samples);
    const std::vector<Tile> tiles = tiles_of_image(0, layout_.rays_across(), layout_.rays_down());
    std::copy(tiles.begin(), tiles.end(), rays_.tiles.as<Tile>());
    if (settings.path == ReferencePath::kSlots) {
        if (!slots_) slots_ = std::make_unique<SlotPath>(device_, field_, rays_);
    } else if (!direct_) {
        direct_ = std::make_unique<DirectPath>(device_, field_, rays_);
    }
}

void ReferenceRenderer::record_path(const ReferenceSettings& settings) {
    const uint32_t tiles = layout_.ray_tiles();
    if (settings.path == ReferencePath::kSlots) {
        record_slice(commands_, slots_->slicer, settings.frame);
        record_trace(commands_, slots_->tracer, tiles, settings.stop);
        return;
    }
    record_rows(commands_, direct_->finder, settings.frame);
    record_direct(commands_, settings.path == ReferencePath::kPaper ? direct_->paper : direct_->direct, tiles,
                  settings.stop);
}

media::Image ReferenceRenderer::render(const stage::Camera& camera, const ReferenceSettings& settings) {
    prepare(camera, settings);
    commands_.begin();
    record_path(settings);
    record_resolve(commands_, resolver_, layout_, settings.resolve);
    {
        const gpu::PassScope scope(commands_, "readback");
        gpu::copy(commands_, image_, readback_, layout_.image_bytes());
        gpu::host_barrier(commands_);
    }
    commands_.submit();
    commands_.wait();
    media::Image image(camera.width, camera.height);
    std::memcpy(image.rgba.data(), readback_.as<uint8_t>(), image.rgba.size());
    return image;
}

std::vector<glm::vec4> ReferenceRenderer::radiance() const {
    return rows_of_view<glm::vec4>(device_, rays_.radiance, layout_, 0);
}

std::vector<float> ReferenceRenderer::depth() const {
    return rows_of_view<float>(device_, rays_.depth, layout_, 0);
}

}  // namespace neuvv::render
