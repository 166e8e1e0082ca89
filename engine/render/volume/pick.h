// Picking on a performer: where rays meet its surface at one time, with its paint.
#pragma once

#include "render/volume/slices/field.h"
#include "render/volume/slices/slice_tree.h"
#include "shared/pick.h"
#include "stage/camera.h"

namespace neuvv::render {

constexpr float kPickAlpha = 0.99f;  // a ray meets the surface where its alpha reaches this value (errata 14)

struct Picked {
    uint32_t leaf = kNoLeaf;  // kNoLeaf: the ray does not reach the alpha
    float distance_m = 0;     // from the ray's origin
    glm::vec3 colour{0};      // linear, of what the ray sees until it reaches the alpha; 0 where not asked for
    bool hit() const { return leaf != kNoLeaf; }
};

// The ray through a point of an image, in pixels from the upper left corner: the centres of pixels are at +0.5. The
// camera and the ray are in the performer's space (in_performer).
PickRay pick_ray(const stage::Camera& camera, glm::dvec2 pixel);

// Whether the colours of surfaces are computed, too, which costs more.
enum class PickColours { kNo, kYes };

// Picks in slices that were built before, and builds nothing.
class SlicePicker {
  public:
    // Takes at most `rays_at_once` rays in one submission. Field and trees must outlive it.
    SlicePicker(const gpu::Device& device, const Field& field, const SliceTrees& trees, uint32_t rays_at_once,
                PickColours colours);

    // Returns a result for each ray, in order, and waits for the device. Rays that follow each other should be close in
    // space, for speed. `slice` is the number of a tree that has been built; `alpha` is above 0 and below 1 (assert).
    std::vector<Picked> pick(uint32_t slice, std::span<const PickRay> rays, float alpha);
    // The same in two calls, for at most rays_at_once() rays (assert): the device picks after what was submitted
    // before, and take() waits for that, but not for what is submitted later. What the picks read must stay until then.
    void begin(uint32_t slice, std::span<const PickRay> rays, float alpha);
    std::vector<Picked> take();
    bool is_picking() const { return picking_ > 0; }  // between begin() and take()
    uint32_t rays_at_once() const { return rays_at_once_; }

  private:
    const Field& field_;
    const SliceTrees& trees_;
    uint32_t rays_at_once_, picking_ = 0;  // rays
    gpu::Buffer rays_, picks_;             // host-mapped
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
    gpu::Commands commands_;
};

// It has a slice of its own and waits for the device, so it is for editing, not for use within a frame.
class Picker {
  public:
    // The field must outlive it.
    Picker(const gpu::Device& device, const Field& field, PickColours colours = PickColours::kNo);

    // Sets the time of the clip (in frames) and the paint of the surface. The layers are not needed afterwards. Throws
    // RuntimeFailure as Paint does.
    void show(float frame, std::span<const PaintUse> paint = {});
    // As SlicePicker::pick, at that time.
    std::vector<Picked> pick(std::span<const PickRay> rays, float alpha = kPickAlpha) {
        return picker_.pick(0, rays, alpha);
    }

  private:
    const gpu::Device& device_;
    const Field& field_;
    LiveLeaves live_;
    SliceTrees trees_;
    TreeSlicer slicer_;
    Painter painter_;
    SlicePicker picker_;
};

}  // namespace neuvv::render
