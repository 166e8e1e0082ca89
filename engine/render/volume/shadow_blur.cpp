#include "render/volume/shadow_blur.h"

#include "shared/shadow_blur.h"
#include "spirv/shadow_blur.comp.h"

namespace neuvv::render {

namespace {

constexpr uint32_t kMapTexels = kPerformerShadowSide * kPerformerShadowSide;

}  // namespace

ShadowBlur::ShadowBlur(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& maps)
    : rows(device, "shadow rows", uint64_t{8} * kMapTexels, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_SFLOAT),
      along_rows(device, "shadow blur", device.buffers().fitting(shadow_blur_comp, shadow_blur_comp_storage), {0}),
      along_columns(device, "shadow blur", device.buffers().fitting(shadow_blur_comp, shadow_blur_comp_storage), {1}),
      rows_set(along_rows, {{kBlurRadiance, &rays.radiance},
                            {kBlurDepth, &rays.depth},
                            {kBlurFrom, &maps},  // bound but not read
                            {kBlurTo, &rows}}),
      columns_set(along_columns,
                  {{kBlurRadiance, &rays.radiance}, {kBlurDepth, &rays.depth}, {kBlurFrom, &rows}, {kBlurTo, &maps}}) {}

void record_shadow_blur(gpu::Commands& commands, const ShadowBlur& blur, std::span<const uint32_t> maps) {
    const gpu::PassScope scope(commands, "shadow blur");
    for (uint32_t view = 0; view < maps.size(); ++view) {
        gpu::dispatch(commands, blur.along_rows, blur.rows_set, kMapTexels, ShadowBlurPush{view, 0});
        gpu::compute_barrier(commands);
        gpu::dispatch(commands, blur.along_columns, blur.columns_set, kMapTexels,
                      ShadowBlurPush{view, maps[view] * kMapTexels});
        gpu::compute_barrier(commands);
    }
}

}  // namespace neuvv::render
