#include "tools/headset/holding.h"

#include "edit/operations.h"

namespace neuvv::headset {

namespace {

constexpr double kReach_m_per_s = 2.5, kLongSelect_s = 0.35, kDeadZone = 0.15;

// Controllers without a grip hold the performer that is pressed for long.
bool wants_to_hold(Hand& hand) {
    if (hand.input.has_grab) return hand.grab.went_down();
    if (hand.selecting_s <= kLongSelect_s || hand.held_long) return false;
    hand.held_long = hand.pressed.what == PointedAt::What::kPerformer;
    return hand.held_long;
}

bool lets_go(const Hand& hand) {
    return hand.input.has_grab ? !hand.grab.held() : !hand.select.held();
}

}  // namespace

void Holding::take(OnStage& on, Hand& hand, int which) {
    if (!hand.aim || hand.at.what != PointedAt::What::kPerformer) return;
    const uint32_t node = on.stage->performers[hand.at.performer].node;
    if (edit::is_locked(on.editor.file(), node)) return on.editor.notify("it is locked: unlock it to move it", true);
    if (grab_ && node != node_) return;  // the other hand holds another one
    if (!grab_) {
        taken_from_ = on.evaluated.pose.world_from_node[node];
        const Ray ray = xr::ray_of(*hand.aim);
        taken_at_ = ray.origin + hand.at.metres * ray.direction;
        grab_.emplace(taken_from_, xr::GrabSettings{settings.upright});
    }
    node_ = node;
    grab_->take(which, *hand.aim, hand.at.metres);
    on.editor.select(node);
    hand.feel(0.7);
}

void Holding::update(OnStage& on, Hands& hands, double dt_s) {
    for (int which = 0; which < xr::kHands; which++) {
        Hand& hand = hands[which];
        if (holds(which) && lets_go(hand)) {
            if (grab_->holds(1 - which))
                grab_->let_go(which);
            else
                put_down(on);
            hand.feel(0.3);
        } else if (!holds(which) && on.tool == HandTool::kArrange && wants_to_hold(hand)) {
            take(on, hand, which);
        }
    }
    if (on.tool != HandTool::kArrange) put_down(on);  // a hand has taken up another tool
    if (!grab_) return;
    for (int which = 0; which < xr::kHands; which++) {
        if (!holds(which) || !hands[which].aim) continue;
        grab_->move(which, *hands[which].aim);
        const double stick = hands[which].input.stick.y;
        if (std::abs(stick) > kDeadZone) grab_->reach(which, stick * kReach_m_per_s * dt_s);
    }
    if (node_ < on.evaluated.pose.world_from_node.size())
        editor::move_node(on.evaluated, *on.stage, node_, grab_->world_from_node());
}

// What is larger or smaller than it was hangs from where it is held, not from its feet: whether it was lifted is told
// by the place where it was taken.
glm::dmat4 Holding::snapped(const OnStage& on, const glm::dmat4& world_from_node) const {
    for (uint32_t performer = 0; performer < on.stage->performers.size() && settings.snaps_to_floor; performer++) {
        if (on.stage->performers[performer].node != node_) continue;
        const auto [low, high] = editor::box_of(on, performer);
        const double above = above_floor(world_from_node, low, high, on.floor_m),
                     before = above_floor(taken_from_, low, high, on.floor_m);
        const glm::dmat4 moved = world_from_node * glm::inverse(taken_from_);
        const double lifted = (moved * glm::dvec4(taken_at_, 1)).y - taken_at_.y;
        const bool stood = std::abs(before) < kSnap_m && std::abs(lifted) < kSnap_m;
        if (above < kSnap_m || stood) return on_floor(world_from_node, low, high, on.floor_m);
    }
    return world_from_node;
}

void Holding::put_down(OnStage& on) {
    if (!grab_) return;
    glm::dmat4 world_from_node = grab_->world_from_node();
    grab_.reset();
    if (node_ >= on.stage->scene.nodes.size()) return;
    world_from_node = snapped(on, world_from_node);
    editor::move_node(on.evaluated, *on.stage, node_, world_from_node);  // until the edit is shown
    stand_at(on, node_, world_from_node);
}

void stand_at(OnStage& on, uint32_t node, const glm::dmat4& world_from_node) {
    const int32_t parent = on.stage->scene.nodes[node].parent;
    const glm::dmat4 world_from_parent =
        parent < 0 ? glm::dmat4(1) : on.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
    edit::Placement placement;
    placement.to = glm::inverse(world_from_parent) * world_from_node;
    on.editor.edit([&](edit::Document& document) { return edit::place_node(document.file, node, placement); });
}

}  // namespace neuvv::headset
