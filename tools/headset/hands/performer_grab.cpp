#include "tools/headset/hands/performer_grab.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "edit/operations.h"
#include "tools/headset/state/arrange.h"

namespace neuvv::headset {

void PerformerGrab::start(HeadsetState& state, Hand& hand, int which) {
    if (!hand.aim || hand.hit.target != PointerHit::Target::kPerformer) return;
    const uint32_t node = state.stage->performers[hand.hit.performer].node;
    if (edit::is_locked(state.editor.file(), node))
        return state.editor.notify("it is locked: unlock it to move it", true);
    if (grab_ && node != node_) return;  // the other hand has grabbed another performer
    if (!grab_) {
        start_transform_ = state.evaluated.pose.world_from_node[node];
        const Ray ray = xr::ray_of(*hand.aim);
        start_point_ = ray.origin + hand.hit.distance_m * ray.direction;
        grab_.emplace(start_transform_, xr::GrabSettings{settings.upright});
    }
    node_ = node;
    grab_->attach(which, *hand.aim, hand.hit.distance_m);
    state.editor.select(node);
    hand.vibrate(0.7);
}

void PerformerGrab::update(HeadsetState& state, Hands& hands, double dt_s) {
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        if (is_grabbing(which) && ends_grab(hand)) {
            if (grab_->is_attached(1 - which))
                grab_->detach(which);
            else
                release(state);
            hand.vibrate(0.3);
        } else if (!is_grabbing(which) && state.tool == HandTool::kArrange &&
                   starts_grab(hand, PointerHit::Target::kPerformer)) {
            start(state, hand, which);
        }
    }
    if (state.tool != HandTool::kArrange) release(state);  // the user has selected another tool
    if (!grab_) return;
    for (int which = 0; which < xr::kHands; ++which) {
        if (!is_grabbing(which) || !hands[which].aim) continue;
        grab_->move(which, *hands[which].aim);
        if (const double by_m = pushed_m(hands[which], dt_s); by_m != 0) grab_->push(which, by_m);
    }
    grab_->advance(dt_s);
    if (node_ < state.evaluated.pose.world_from_node.size())
        editor::move_node(state.evaluated, *state.stage, node_, moved());
}

// Where the hands have moved the node, in steps where the user wants these. The heading is that of the node's +Z, its
// front. It turns about the grabbed point, so that this stays in the hand.
glm::dmat4 PerformerGrab::moved() const {
    glm::dmat4 world_from_node = grab_->world_from_node();
    if (settings.steps_heading) {
        const glm::dvec3 front = glm::dvec3(world_from_node[2]);
        const double heading = std::atan2(front.x, front.z), step = kHeadingStep_rad;
        const glm::dvec3 held = world_from_node * glm::inverse(start_transform_) * glm::dvec4(start_point_, 1);
        const glm::dmat4 turn = glm::mat4_cast(xr::turn_by(std::round(heading / step) * step - heading));
        world_from_node =
            glm::translate(glm::dmat4(1), held) * turn * glm::translate(glm::dmat4(1), -held) * world_from_node;
    }
    if (settings.steps_place)
        for (const int axis : {0, 2})
            world_from_node[3][axis] = std::round(world_from_node[3][axis] / kPlaceStep_m) * kPlaceStep_m;
    return world_from_node;
}

// Scaling happens about the grabbed point, not about the performer's feet. So the height of the grabbed point says
// whether the performer was lifted.
glm::dmat4 PerformerGrab::snapped(const HeadsetState& state, const glm::dmat4& world_from_node) const {
    for (uint32_t performer = 0; performer < state.stage->performers.size() && settings.snaps_to_floor; ++performer) {
        if (state.stage->performers[performer].node != node_) continue;
        const auto [low, high] = editor::box_of(state, performer);
        const double above = above_floor(world_from_node, low, high, state.floor_m),
                     before = above_floor(start_transform_, low, high, state.floor_m);
        const glm::dmat4 moved = world_from_node * glm::inverse(start_transform_);
        const double lifted = (moved * glm::dvec4(start_point_, 1)).y - start_point_.y;
        const bool stood = std::abs(before) < kSnapDistance_m && std::abs(lifted) < kSnapDistance_m;
        const bool near_floor = above < kSnapDistance_m && above > -kSunkDistance_m;
        if (near_floor || stood) return on_floor(world_from_node, low, high, state.floor_m);
    }
    return world_from_node;
}

void PerformerGrab::release(HeadsetState& state) {
    if (!grab_) return;
    glm::dmat4 world_from_node = moved();
    grab_.reset();
    if (node_ >= state.stage->scene.nodes.size()) return;
    world_from_node = snapped(state, world_from_node);
    editor::move_node(state.evaluated, *state.stage, node_, world_from_node);  // until the edited document is evaluated
    move_node_to(state, node_, world_from_node);
}

}  // namespace neuvv::headset
