// FrameRenderer: picks in the slices that images have left.
#include <cmath>
#include <utility>

#include "render/frame/frame.h"

namespace neuvv::render {

// The built slice of the instance's field, or of a coarser level of it, whose time is nearest to the instance's, and
// the performer that has it. Null where there is none within kPickedNear frames.
std::pair<Performer*, uint32_t> FrameRenderer::built_slice(const Instance& instance) const {
    std::pair<Performer*, uint32_t> nearest{nullptr, 0};
    if (instance.field >= levels_.given()) return nearest;
    float away = kPickedNear;
    const auto levels = 1 + static_cast<uint32_t>(levels_.all[instance.field]->coarser.size());
    for (uint32_t level = 0; level < levels; ++level) {
        const uint32_t index = levels_.index(instance.field, level);
        if (index >= performers_.size() || !performers_[index] || !performers_[index]->slices()) continue;
        const auto built = performers_[index]->slices()->nearest_built({instance.frame, instance.paint});
        if (!built || std::abs(built->first.frame - instance.frame) > away) continue;
        if (nearest.first && std::abs(built->first.frame - instance.frame) == away) continue;  // a finer level has it
        nearest = {performers_[index].get(), built->second};
        away = std::abs(built->first.frame - instance.frame);
    }
    return nearest;
}

bool FrameRenderer::begin_pick(const Instance& instance, std::span<const PickRay> rays, float alpha) {
    const auto [performer, slice] = built_slice(instance);
    if (!performer) return false;
    picks_.begin(*performer, slice, rays, alpha);
    return true;
}

}  // namespace neuvv::render
