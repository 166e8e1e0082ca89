// What the buttons of hands and panel do with the selected performer: copy it once or many times, delete it, put it on
// the floor.
#pragma once

#include "tools/headset/state/headset_state.h"

namespace neuvv::headset {

// Edits the document: adds a copy beside the selected node, so that what is solid of both does not touch, and selects
// the copy. Where somebody stands there already, the copy comes to the next place in the row that is free, to either
// side.
void duplicate_selected(HeadsetState& state);
// Edits the document: adds the copies of the selected performer that HeadsetState::copies asks for, as one step. The
// performer stays selected. Where a copy would stand inside of somebody else, the user is told so instead.
void make_copies(HeadsetState& state);
// Where they would stand: the transform of each in the world, and whether somebody else stands there already. Empty
// where no performer is selected.
struct PlannedCopy {
    glm::dmat4 world_from_node{1};
    bool is_taken = false;
};
std::vector<PlannedCopy> planned_copies(const HeadsetState& state);
// How far along a direction (world, unit) a performer that would have this transform has to be moved, so that it stands
// beside all others; 0 where nobody stands there.
double free_shift_m(const HeadsetState& state, uint32_t performer, const glm::dmat4& world_from_performer,
                    const glm::dvec3& along);
// Edits the document: removes the selected node, unless it is locked.
void delete_selected(HeadsetState& state);
// Edits the document: moves the selected performer up or down so that its feet, which are the bottom of what is solid
// of it at this time, are on the floor. Where they are more than kFloorReach_m above or below the floor, the user is
// told so instead: such a performer is hardly meant to stand there.
void put_selected_on_floor(HeadsetState& state);
constexpr double kFloorReach_m = 1;

// The transform of the node above a node; that of the world where there is none.
glm::dmat4 world_from_parent(const HeadsetState& state, uint32_t node);
// Edits the document: gives a node this transform, and applies `more`, where there is any, in the same step.
void move_node_to(HeadsetState& state, uint32_t node, const glm::dmat4& world_from_node,
                  const editor::Editor::Operation& more = {});
// Edits the document: turns a node so that its −Z points at this point of the world.
void aim_node_at(HeadsetState& state, uint32_t node, const glm::dvec3& at);
// The transform that aim_node_at gives the node, world from node; nullopt where it cannot be done.
std::optional<glm::dmat4> aimed_at(const HeadsetState& state, uint32_t node, const glm::dvec3& at);

}  // namespace neuvv::headset
