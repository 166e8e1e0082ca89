#include "editor/paint_surface.h"

#include <algorithm>
#include <cmath>

namespace neuvv::editor {

namespace {

constexpr float kSurface = 0.5f;  // what a pixel shows, soft or not: where a ray has gathered so much

std::vector<render::PaintUse> uses_of(const PaintSubject& subject) {
    std::vector<render::PaintUse> uses;
    for (const WornLayer& worn : subject.paint) uses.push_back({worn.layer.get(), worn.blend, worn.opacity});
    return uses;
}

// Both in order of leaves; of a leaf that is in both, the larger share.
std::vector<SelectedLeaf> united(const std::vector<SelectedLeaf>& a, const std::vector<voctree::LeafEdit>& b) {
    std::vector<SelectedLeaf> all;
    all.reserve(a.size() + b.size());
    auto next = a.begin();
    for (const voctree::LeafEdit& edit : b) {
        for (; next != a.end() && next->leaf < edit.leaf; ++next) all.push_back(*next);
        const bool known = next != a.end() && next->leaf == edit.leaf;
        all.push_back({edit.leaf, known ? std::max(next->share, edit.alpha) : edit.alpha});
        if (known) ++next;
    }
    all.insert(all.end(), next, a.end());
    return all;
}

}  // namespace

void PaintSurface::show(const PaintSubject& subject) {
    if (picker_ && subject == subject_) return;
    const bool other_field = !picker_ || subject.field != subject_.field;
    if (other_field) {
        picker_.reset();
        picker_ = std::make_unique<render::Picker>(device_, *subject.field);
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
    subject_ = {};
    sigma_ = {};
}

std::optional<glm::dvec3> PaintSurface::surface_at(const stage::Camera& camera, glm::dvec2 pixel) {
    const PickRay ray = render::pick_ray(camera, pixel);
    const render::Picked picked = picker_->pick({&ray, 1}, kSurface)[0];
    if (!picked.hit()) return std::nullopt;
    return glm::dvec3(ray.origin) + double{picked.distance_m} * glm::dvec3(ray.direction);
}

// The line to the first new place begins with a touch at the last one again, which lies beside itself in the stroke
// and so covers nothing new.
std::shared_ptr<const voctree::EditLayer> Stroke::add(PaintSurface& surface, const stage::Camera& camera,
                                                      std::span<const glm::dvec2> places) {
    surface.show(subject_);
    if (camera.world_from_camera != seen_from_) last_.reset();
    seen_from_ = camera.world_from_camera;
    std::vector<glm::dvec2> line;
    if (last_) line.push_back(*last_);
    line.insert(line.end(), places.begin(), places.end());
    if (line.empty()) return nullptr;
    last_ = line.back();
    const std::vector<edit::Touch> touches = edit::touches_under(surface.picker(), camera, line);
    covered_ = united(covered_, edit::stroke(surface.canvas(), surface.sigma(), tip_, touches));
    return apply_operation(surface.canvas(), *before_, covered_, operation_);
}

Projection::Projection(PaintSubject subject, std::shared_ptr<const voctree::EditLayer> before, Settings settings)
    : subject_(std::move(subject)), before_(std::move(before)), settings_(std::move(settings)) {
    if (!settings_.every_frame) return;
    next_ = static_cast<uint32_t>(std::ceil(settings_.frames.first));
    last_ = static_cast<uint32_t>(settings_.frames.last);
}

bool Projection::step(PaintSurface& surface) {
    if (next_ > last_) return false;
    if (settings_.every_frame) subject_.frame = static_cast<float>(next_);
    surface.show(subject_);
    std::vector<voctree::LeafEdit> edits =
        edit::project(surface.picker(), surface.canvas(), surface.sigma(), settings_.image, settings_.camera);
    for (voctree::LeafEdit& edit : edits) {
        edit.alpha *= settings_.opacity;
        edit.first = edit.last = subject_.frame;
    }
    if (settings_.every_frame)
        edits_.insert(edits_.end(), edits.begin(), edits.end());
    else
        edits_ = edit::at_frames(surface.canvas(), edits, settings_.frames);
    return next_++ < last_;
}

std::shared_ptr<const voctree::EditLayer> Projection::layer() const {
    if (edits_.empty()) return nullptr;
    auto after = std::make_shared<voctree::EditLayer>(*before_);
    const edit::EditFrames& frames = settings_.frames;
    voctree::add_edits(*after,
                       settings_.every_frame ? edit::through_between(edits_, frames.first, frames.last) : edits_);
    return after;
}

media::Image reduced(const media::Image& image, uint32_t factor) {
    if (factor <= 1) return image;
    media::Image small((image.width + factor - 1) / factor, (image.height + factor - 1) / factor);
    for (uint32_t y = 0; y < small.height; y++)
        for (uint32_t x = 0; x < small.width; x++) {
            glm::vec4 sum(0);  // premultiplied, linear
            float count = 0;
            for (uint32_t row = y * factor; row < std::min((y + 1) * factor, image.height); row++)
                for (uint32_t column = x * factor; column < std::min((x + 1) * factor, image.width); column++) {
                    const uint8_t* rgba = image.at(column, row);
                    const float alpha = static_cast<float>(rgba[3]) / 255;
                    const glm::vec3 colour(media::linear_from_srgb_byte(rgba[0]), media::linear_from_srgb_byte(rgba[1]),
                                           media::linear_from_srgb_byte(rgba[2]));
                    sum += glm::vec4(alpha * colour, alpha);
                    count++;
                }
            uint8_t* to = small.at(x, y);
            for (int c = 0; c < 3; c++) to[c] = media::srgb_byte_from_linear(sum.a > 0 ? sum[c] / sum.a : 0);
            to[3] = static_cast<uint8_t>(std::lround(255 * sum.a / count));
        }
    return small;
}

}  // namespace neuvv::editor
