// The surface that is painted on, for tasks of the render thread: a performer's field on host and device, as it is at
// one frame.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "edit/project.h"

namespace neuvv::editor {

// A clip on the host, with what painting needs to know of its leaves. A large clip takes seconds to prepare.
struct PaintClip {
    explicit PaintClip(voctree::VOctree read)
        : tree(std::move(read)), field(voctree::painted_field(tree)), canvas(tree) {}
    PaintClip(const PaintClip&) = delete;
    PaintClip& operator=(const PaintClip&) = delete;
    voctree::VOctree tree;
    voctree::PaintedField field;
    edit::Canvas canvas;
};

// A layer of paint that the performer has and that is visible.
struct VisibleLayer {
    std::shared_ptr<const voctree::EditLayer> layer;
    stage::PaintBlend blend = stage::PaintBlend::kNormal;
    float opacity = 1;
    bool operator==(const VisibleLayer&) const = default;
};

// What is painted on. Touches and projections, which need to see the surface, need `field`; regions do not.
struct PaintSubject {
    std::shared_ptr<const PaintClip> clip;
    // The clip on the device. Others own it: tasks that wait with their subject may outlive the device.
    std::weak_ptr<const render::Field> field;
    float frame = 0;
    std::vector<VisibleLayer> paint;  // the visible layers, the lowest first
    bool has_field_of(const PaintSubject& other) const {
        return !field.owner_before(other.field) && !other.field.owner_before(field);
    }
    bool operator==(const PaintSubject& other) const {
        return clip == other.clip && has_field_of(other) && frame == other.frame && paint == other.paint;
    }
};

class PaintSurface {
  public:
    explicit PaintSurface(const gpu::Device& device) : device_(device) {}

    // Prepares the surface for this subject, until the next call; does nothing where the subject is the same. Throws
    // RuntimeFailure where the device has no memory left, or the subject's field is gone.
    void show(const PaintSubject& subject);
    // Frees everything that show() prepared.
    void clear();

    // These need a subject. Cameras are in the performer's space (in_performer).
    const edit::Canvas& canvas() const { return subject_.clip->canvas; }
    std::span<const float> sigma() const { return sigma_; }  // 1/m, of each leaf (densities())
    render::Picker& picker() { return *picker_; }
    // The point of the surface that a pixel shows, in the performer's space; nullopt where the pixel shows none.
    std::optional<glm::dvec3> surface_at(const stage::Camera& camera, glm::dvec2 pixel);

  private:
    const gpu::Device& device_;
    PaintSubject subject_;
    std::shared_ptr<const render::Field> field_;  // that of the subject
    std::vector<float> sigma_;
    std::unique_ptr<render::Picker> picker_;  // of subject_.field
};

}  // namespace neuvv::editor
