#include "render/clips/stage_pick.h"

#include <cassert>
#include <cmath>
#include <utility>

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

void keep_nearer(std::optional<PickedPerformer>& nearest, uint32_t performer, const Picked& found,
                 double world_per_local) {
    const double at_m = world_per_local * double{found.distance_m};
    if (found.hit() && (!nearest || at_m < nearest->distance_m)) nearest = {performer, at_m, found.colour};
}

}  // namespace

void PerformerPicks::begin(StageRenderer& renderer, const stage::EvaluatedStage& evaluated, std::span<const Ray> rays) {
    renderer.frames().take_picks();  // of an earlier begin() that nobody took
    begun_.clear();
    rays_ = rays.size();
    for (const stage::EvaluatedPerformer& performer : evaluated.performers) {
        const std::optional<Instance> instance = renderer.instance_of(performer);
        if (!instance || performer.opacity <= 0) continue;
        const auto [low, high] = renderer.leaf_box(performer.clip);
        const glm::dmat4 performer_from_world = glm::inverse(performer.world_from_performer);
        Begun begun{performer.performer, {}, {}};
        std::vector<PickRay> to_pick;
        for (size_t i = 0; i < rays.size(); ++i) {
            if (!box_hit(rays[i], performer.world_from_performer, low, high)) continue;
            const LocalRay local = local_ray(rays[i], performer_from_world);
            begun.rays.push_back(i);
            begun.world_per_local.push_back(local.world_per_local);
            to_pick.push_back(local.ray);
        }
        if (!to_pick.empty() && renderer.frames().begin_pick(*instance, to_pick, kPointedAlpha))
            begun_.push_back(std::move(begun));
    }
}

std::vector<std::optional<PickedPerformer>> PerformerPicks::take(StageRenderer& renderer) {
    std::vector<std::optional<PickedPerformer>> picked(std::exchange(rays_, 0));
    const std::vector<Begun> begun = std::exchange(begun_, {});
    const std::vector<std::vector<Picked>> found = renderer.frames().take_picks();
    assert(found.size() == begun.size() && "one PerformerPicks at a time for a renderer");
    for (size_t k = 0; k < begun.size(); ++k)
        for (size_t i = 0; i < begun[k].rays.size(); ++i)
            keep_nearer(picked[begun[k].rays[i]], begun[k].performer, found[k][i], begun[k].world_per_local[i]);
    return picked;
}

std::vector<std::optional<PickedPerformer>> pick_performers(StageRenderer& renderer,
                                                            const stage::EvaluatedStage& evaluated,
                                                            std::span<const Ray> rays) {
    PerformerPicks picks;
    picks.begin(renderer, evaluated, rays);
    return picks.take(renderer);
}

}  // namespace neuvv::render
