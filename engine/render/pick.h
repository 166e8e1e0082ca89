// Picking on a performer: where rays meet its surface at one time, with its paint.
#pragma once

#include "render/field.h"
#include "render/slice_tree.h"
#include "shared/pick.h"
#include "stage/camera.h"

namespace neuvv::render {

constexpr float kPickAlpha = 0.99f;  // a ray meets the surface where its alpha reaches this value (errata 14)

struct Picked {
    uint32_t leaf = kNoLeaf;  // kNoLeaf: the ray does not reach the alpha
    float distance_m = 0;     // from the ray's origin
    bool hit() const { return leaf != kNoLeaf; }
};

// The ray through a point of an image, in pixels from the upper left corner: the centres of pixels are at +0.5. The
// camera and the ray are in the performer's space (in_performer).
PickRay pick_ray(const stage::Camera& camera, glm::dvec2 pixel);

// It has a slice of its own and waits for the device, so it is for editing, not for use within a frame.
class Picker {
  public:
    // The field must outlive it.
    Picker(const gpu::Device& device, const Field& field);

    // Sets the time of the clip (in frames) and the paint of the surface. The layers are not needed afterwards. Throws
    // RuntimeFailure as Paint does.
    void show(float frame, std::span<const PaintUse> paint = {});
    // Returns a result for each ray, in order. Rays that follow each other should be close in space, for speed. `alpha`
    // is above 0 and below 1 (assert).
    std::vector<Picked> pick(std::span<const PickRay> rays, float alpha = kPickAlpha);

  private:
    std::vector<Picked> pick_batch(std::span<const PickRay> rays, float alpha);
    const gpu::Device& device_;
    const Field& field_;
    LiveLeaves live_;
    SliceTrees trees_;
    TreeSlicer slicer_;
    Painter painter_;
    gpu::Buffer rays_, picks_;  // host-mapped
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
};

}  // namespace neuvv::render
