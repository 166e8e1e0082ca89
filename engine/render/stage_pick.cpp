#include "render/stage_pick.h"

#include <cmath>

namespace neuvv::render {

namespace {

// A ray in the performer's space, and how many metres of the world a metre along it is.
struct LocalRay {
    PickRay ray;
    double world_per_local = 1;
};
LocalRay local_ray(const Ray& ray, const glm::dmat4& performer_from_world) {
    const glm::dvec3 origin = performer_from_world * glm::dvec4(ray.origin, 1),
                     along = performer_from_world * glm::dvec4(ray.direction, 0);
    const double length = glm::length(along);
    return {{glm::vec4(glm::vec3(origin), 0), glm::vec4(glm::vec3(along / length), 0)}, 1 / length};
}

}  // namespace

std::vector<std::optional<PickedPerformer>> pick_performers(StageRenderer& renderer,
                                                            const stage::EvaluatedStage& evaluated,
                                                            std::span<const Ray> rays) {
    std::vector<std::optional<PickedPerformer>> picked(rays.size());
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        const std::optional<Instance> instance = renderer.instance_of(performer);
        if (!instance || performer.opacity <= 0) continue;
        const auto [low, high] = renderer.leaf_box(performer.clip);
        const glm::dmat4 performer_from_world = glm::inverse(performer.world_from_performer);
        std::vector<size_t> meeting;  // those of the rays that meet the box before they meet another performer
        std::vector<LocalRay> local;
        std::vector<PickRay> to_pick;
        for (size_t i = 0; i < rays.size(); i++) {
            const auto enters_m = box_hit(rays[i], performer.world_from_performer, low, high);
            if (!enters_m || (picked[i] && picked[i]->distance_m < *enters_m)) continue;
            meeting.push_back(i);
            local.push_back(local_ray(rays[i], performer_from_world));
            to_pick.push_back(local.back().ray);
        }
        if (meeting.empty()) continue;
        const auto found = renderer.frames().pick(*instance, to_pick, kPointedAlpha);
        for (size_t i = 0; found && i < meeting.size(); i++) {
            std::optional<PickedPerformer>& nearest = picked[meeting[i]];
            const double at_m = local[i].world_per_local * double{(*found)[i].distance_m};
            if ((*found)[i].hit() && (!nearest || at_m < nearest->distance_m))
                nearest = {performer.performer, at_m, (*found)[i].colour};
        }
    }
    return picked;
}

}  // namespace neuvv::render
