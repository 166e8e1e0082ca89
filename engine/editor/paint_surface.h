// What is painted on, on the render thread: a performer's field on host and device, as it shows at a frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "edit/project.h"

namespace neuvv::editor {

// A field on the host, as painting reads it. A large one takes seconds to make.
struct PaintClip {
    explicit PaintClip(voctree::VOctree read)
        : tree(std::move(read)), field(voctree::painted_field(tree)), canvas(tree) {}
    PaintClip(const PaintClip&) = delete;
    PaintClip& operator=(const PaintClip&) = delete;
    voctree::VOctree tree;
    voctree::PaintedField field;
    edit::Canvas canvas;
};

struct VisibleLayer {
    std::shared_ptr<const voctree::EditLayer> layer;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    bool operator==(const VisibleLayer&) const = default;
};

// What is painted on. What looks at the surface needs `field`; what works on regions alone does not.
struct PaintSubject {
    std::shared_ptr<const PaintClip> clip;
    std::shared_ptr<const render::Field> field;  // the same on the device
    float frame = 0;
    std::vector<VisibleLayer> paint;  // that shows, the lowest first
    bool operator==(const PaintSubject&) const = default;
};

class PaintSurface {
  public:
    explicit PaintSurface(const gpu::Device& device) : device_(device) {}

    // The subject until the next call; nothing is done where it is the same. Throws RuntimeFailure where the device has
    // no room.
    void show(const PaintSubject& subject);
    // Frees everything.
    void clear();

    // Of the subject; there must be one. Cameras are in the performer's space (in_performer).
    const edit::Canvas& canvas() const { return subject_.clip->canvas; }
    std::span<const float> sigma() const { return sigma_; }  // densities
    render::Picker& picker() { return *picker_; }
    // The point of the surface that a pixel shows, in the performer's space.
    std::optional<glm::dvec3> surface_at(const stage::Camera& camera, glm::dvec2 pixel);

  private:
    const gpu::Device& device_;
    PaintSubject subject_;
    std::vector<float> sigma_;
    std::unique_ptr<render::Picker> picker_;  // of subject_.field
};

}  // namespace neuvv::editor
