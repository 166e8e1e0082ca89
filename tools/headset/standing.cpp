#include "tools/headset/standing.h"

#include <algorithm>
#include <cmath>

namespace neuvv::headset {

namespace {

constexpr double kWanted_m = 0.5 * (kNearest_m + kFarthest_m), kInside_m = 0.5;

struct Neighbour {
    double away_m = INFINITY;  // INFINITY: there is none
    glm::dvec3 centre{0};      // at the height of the place that it is the neighbour of
};

// The nearest performer that is seen. How near it is grows by at most one metre for each that one goes.
Neighbour nearest_performer(const HeadsetState& state, glm::dvec3 at) {
    Neighbour nearest;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (!performer.visible) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        const glm::dmat4& world = performer.world_from_performer;
        glm::dvec3 centre = world * glm::dvec4(0.5 * (low + high), 1);
        centre.y = at.y;
        glm::dvec3 beside(0);  // how far the place lies outside of the box, along each horizontal axis
        for (const int axis : {0, 2}) {
            const glm::dvec3 along(world[axis].x, 0, world[axis].z);
            const double scale = glm::length(along);
            if (scale > 0)
                beside[axis] = std::max(
                    std::abs(glm::dot(at - centre, along)) / scale - 0.5 * (high[axis] - low[axis]) * scale, 0.0);
        }
        const double away_m = std::min(glm::distance(at, centre), glm::length(beside) + kInside_m);
        if (away_m < nearest.away_m) nearest = {away_m, centre};
    }
    return nearest;
}

glm::dvec3 ahead_of(double yaw_rad) {
    return xr::turn_by(yaw_rad) * glm::dvec3(0, 0, -1);
}

// The place that is ahead of this one, or behind it, at the right distance from the nearest performer; nullopt where
// there is none.
std::optional<glm::dvec3> place_along(const HeadsetState& state, glm::dvec3 at, glm::dvec3 ahead) {
    constexpr int kSteps = 256;
    double last_m = INFINITY;
    for (int i = 0; i < kSteps; ++i) {
        const double away_m = nearest_performer(state, at).away_m;
        if (away_m >= kNearest_m && away_m <= kFarthest_m) return at;
        if (away_m > kFarthest_m && away_m >= last_m) return std::nullopt;  // it has gone past them all
        last_m = away_m > kFarthest_m ? away_m : INFINITY;
        at += (away_m - kWanted_m) * ahead;
    }
    return std::nullopt;
}

// Below the stage's first perspective camera; else before the centre of what is solid of the performers, so that all of
// them are ahead.
StandingPlace place_of_camera(const HeadsetState& state) {
    for (const stage::EvaluatedCamera& camera : state.evaluated.cameras) {
        if (camera.orthographic) continue;
        const glm::dvec3 at(camera.world_from_camera[3]), ahead = -glm::dvec3(camera.world_from_camera[2]);
        return {{at.x, state.floor_m, at.z}, std::atan2(-ahead.x, -ahead.z)};
    }
    glm::dvec3 lowest(INFINITY), highest(-INFINITY);
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        const auto [low, high] = editor::box_of(state, performer.performer);
        for (int corner = 0; corner < 8 && performer.visible; ++corner) {
            const glm::dvec3 of_box(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y,
                                    corner & 4 ? high.z : low.z);
            const glm::dvec3 at = performer.world_from_performer * glm::dvec4(of_box, 1);
            lowest = glm::min(lowest, at);
            highest = glm::max(highest, at);
        }
    }
    if (!(lowest.x <= highest.x)) return {{0, state.floor_m, kWanted_m}, 0};
    return {{0.5 * (lowest.x + highest.x), state.floor_m, highest.z + kWanted_m}, 0};
}

}  // namespace

StandingPlace first_place(const HeadsetState& state) {
    StandingPlace place = place_of_camera(state);
    const Neighbour nearest = nearest_performer(state, place.floor_point);
    if (!std::isfinite(nearest.away_m)) return place;
    if (const auto ahead = place_along(state, place.floor_point, ahead_of(place.yaw_rad))) {
        place.floor_point = *ahead;
        return place;
    }
    const glm::dvec3 towards = nearest.centre - place.floor_point;
    if (!(glm::length(towards) > 0)) return place;
    const double yaw_rad = std::atan2(-towards.x, -towards.z);
    if (const auto beside = place_along(state, place.floor_point, ahead_of(yaw_rad))) place = {*beside, yaw_rad};
    return place;
}

void stand_at(HeadsetState& state, const StandingPlace& place, const xr::Pose& head) {
    const glm::dvec3 floor_point = place.floor_point + glm::dvec3(0, state.raised_m, 0);
    state.rig = xr::with_head_above({}, head, floor_point, place.yaw_rad);
    state.ahead_rad = place.yaw_rad;
}

void follow_tracking_change(HeadsetState& state, const xr::TrackingChange& change, const xr::Pose& before,
                            const xr::Pose& now) {
    if (!change.by_user && change.old_from_new) {
        state.rig = xr::in_new_space(state.rig, *change.old_from_new);
        return;
    }
    const xr::Pose was = xr::world_from_tracking(state.rig) * before;
    const glm::dvec3 below(was.position.x, state.rig.position.y, was.position.z);
    state.rig = xr::with_head_above(state.rig, now, below, change.by_user ? state.ahead_rad : xr::yaw_of(was.rotation));
}

}  // namespace neuvv::headset
