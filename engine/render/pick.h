// Picking on a performer: where rays meet its surface at a time, as it is painted.
#pragma once

#include "render/field.h"
#include "render/slice_tree.h"
#include "shared/pick.h"
#include "stage/camera.h"

namespace neuvv::render {

constexpr float kPickAlpha = 0.99f;  // a ray meets the surface where it has gathered so much (errata 14)

struct Picked {
    uint32_t leaf = kNoLeaf;  // kNoLeaf: the ray meets nothing, or too little
    float distance_m = 0;     // from the ray's origin
    bool hit() const { return leaf != kNoLeaf; }
};

// The ray of a place in an image, as pixels count: centres at +0.5. The camera in the performer's space
// (in_performer).
PickRay pick_ray(const stage::Camera& camera, glm::dvec2 pixel);

// For set-up and editing, not for frames: it has a slice of its own, and waits for the device.
class Picker {
  public:
    // The field must outlive it.
    Picker(const gpu::Device& device, const Field& field);

    // The time that is picked on, and the paint at it, which is not needed afterwards.
    void show(float frame, std::span<const PaintUse> paint = {});
    // In the order of the rays; neighbours in it should be neighbours in space.
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
