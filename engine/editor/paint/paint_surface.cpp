#include "editor/paint/paint_surface.h"

#include "base/error.h"

namespace neuvv::editor {

namespace {

constexpr float kSurface = 0.5f;  // the alpha that a ray has gathered at the surface, even where the surface is soft

std::vector<render::PaintUse> uses_of(const PaintSubject& subject) {
    std::vector<render::PaintUse> uses;
    for (const VisibleLayer& layer : subject.paint) uses.push_back({layer.layer.get(), layer.blend, layer.opacity});
    return uses;
}

}  // namespace

void PaintSurface::show(const PaintSubject& subject) {
    if (picker_ && subject == subject_) return;
    if (!picker_ || !subject.has_field_of(subject_)) {
        clear();
        field_ = subject.field.lock();
        if (!field_) throw RuntimeFailure("what is painted on is not on the device any more; paint again");
        picker_ = std::make_unique<render::Picker>(device_, *field_);
    }
    subject_ = subject;
    try {
        const std::vector<render::PaintUse> uses = uses_of(subject);
        sigma_ = edit::densities(subject.clip->canvas, subject.frame, uses);
        picker_->show(subject.frame, uses);
    } catch (...) {
        clear();
        throw;
    }
}

void PaintSurface::clear() {
    picker_.reset();
    field_.reset();
    subject_ = {};
    sigma_ = {};
}

std::optional<glm::dvec3> PaintSurface::surface_at(const stage::Camera& camera, glm::dvec2 pixel) {
    const PickRay ray = render::pick_ray(camera, pixel);
    const render::Picked picked = picker_->pick({&ray, 1}, kSurface)[0];
    if (!picked.hit()) return std::nullopt;
    return glm::dvec3(ray.origin) + double{picked.distance_m} * glm::dvec3(ray.direction);
}

}  // namespace neuvv::editor
