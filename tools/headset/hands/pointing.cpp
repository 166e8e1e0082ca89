#include "tools/headset/hands/pointing.h"

#include "tools/headset/draw/markers.h"
#include "xr/ray_hit.h"

namespace neuvv::headset {

namespace {

constexpr double kMaxRay_m = 30, kTick = 0.12, kSame_m = 1e-3;

std::optional<SurfaceHit> nearest_box(const Ray& ray, const HeadsetState& state) {
    std::optional<SurfaceHit> nearest;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (!performer.visible) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        const auto distance_m = box_hit(ray, performer.world_from_performer, low, high);
        if (distance_m && (!nearest || *distance_m < nearest->distance_m))
            nearest = SurfaceHit{performer.performer, *distance_m};
    }
    return nearest;
}

// The floor or, with `set`, what of the set is nearer. The set mostly has a floor of its own in the same place.
PointerHit hit_on_set(const Ray& ray, const HeadsetState& state, const editor::SetSurface* set) {
    const double down = -ray.direction.y, to_floor = (ray.origin.y - state.floor_m) / down;
    PointerHit hit;
    if (down > 1e-3 && to_floor > 0) hit = {PointerHit::Target::kFloor, to_floor};
    const auto on_set = set ? set->meet(ray) : std::nullopt;
    const bool is_floor = hit.target == PointerHit::Target::kFloor && on_set && on_set->distance_m > to_floor - kSame_m;
    if (on_set && !is_floor) hit = {PointerHit::Target::kSet, on_set->distance_m};
    return hit.distance_m < kMaxRay_m ? hit : PointerHit{};
}

PointerHit hit_on_stage(const Ray& ray, const HeadsetState& state, std::optional<SurfaceHit> surface,
                        const editor::SetSurface* set) {
    const auto marker = marker_on(ray, state);
    if (marker && (!surface || marker->distance_m < surface->distance_m))
        return {PointerHit::Target::kMarker, marker->distance_m, {}, 0, marker->node};
    // What a light looks at is a surface.
    const bool boxes_count = state.tool != HandTool::kLights;
    if (boxes_count && (!surface || surface->distance_m >= kMaxRay_m)) surface = nearest_box(ray, state);
    const PointerHit behind = hit_on_set(ray, state, set);
    const bool is_hidden =
        behind.target == PointerHit::Target::kSet && surface && behind.distance_m < surface->distance_m;
    if (surface && surface->distance_m < kMaxRay_m && !is_hidden)
        return {PointerHit::Target::kPerformer, surface->distance_m, {}, surface->performer, 0, surface->colour};
    return behind;
}

void feel_change(Hand& hand, const HeadsetState& state) {
    std::optional<uint32_t> node;
    if (hand.hit.target == PointerHit::Target::kPerformer) node = state.stage->performers[hand.hit.performer].node;
    if (hand.hit.target == PointerHit::Target::kMarker) node = hand.hit.node;
    if (node && node != hand.pointed_node) hand.vibrate(kTick);
    hand.pointed_node = node;
}

}  // namespace

void point(Hands& hands, const HeadsetState& state, const std::optional<PanelPlacement>& panel,
           const FindSurfaces& find_surfaces, const editor::SetSurface* set) {
    std::vector<Ray> rays;
    std::vector<Hand*> pointing;  // at the stage, by ray
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        hand.hit = {};
        if (!hand.aim) continue;
        const Ray ray = xr::ray_of(*hand.aim);
        const bool carries_panel = state.panel_on_wrist && which == xr::kLeft;
        const auto on_panel =
            panel && !carries_panel ? xr::rectangle_hit(ray, panel->world_from_panel, panel->size_m) : std::nullopt;
        if (on_panel) {
            hand.hit = {PointerHit::Target::kPanel, on_panel->distance_m, on_panel->uv};
            continue;
        }
        rays.push_back(ray);
        pointing.push_back(&hand);
    }
    std::vector<std::optional<SurfaceHit>> surfaces(rays.size());
    if (find_surfaces && !rays.empty()) surfaces = find_surfaces(rays);
    for (size_t i = 0; i < rays.size(); ++i) pointing[i]->hit = hit_on_stage(rays[i], state, surfaces[i], set);
    for (Hand& hand : hands) feel_change(hand, state);
}

std::optional<uint32_t> pointed_performer(const Hands& hands) {
    for (const int which : {xr::kRight, xr::kLeft})
        if (hands[which].hit.target == PointerHit::Target::kPerformer) return hands[which].hit.performer;
    return std::nullopt;
}

}  // namespace neuvv::headset
