// Drawing over the image, what the pointer points at, and views of the stage: what several tools and panels use.
#pragma once

#include <imgui.h>

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>

#include "tools/viewer/context.h"
#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

// The point of the window that shows a pixel of the image.
ImVec2 in_window(const Context& context, glm::dvec2 pixel);
// Draws the visible part of a segment of the world. `colour` is as ImGui's, `width` in pixels at scale 1.
void draw_line(const Context& context, glm::dvec3 a, glm::dvec3 b, unsigned colour, float width);
// Draws the grid on the floor, icons at lights and cameras, and the box around the selected node.
void draw_scene_overlay(const Context& context);
// Draws handles. `hot` is the handle that is dragged or under the pointer, and is highlighted; 0: none.
void draw_handles(const Context& context, std::span<const HandleShape> shapes, int hot);

// The node of the light or camera whose icon is at this point of the window; nullopt: there is none.
std::optional<uint32_t> icon_at(const Context& context, float x, float y);
// The position of the pointer, in pixels of the image.
glm::dvec2 pointer_of(const Context& context);
// The corners, low and high, of the box around the performers and meshes of a node and its descendants, in the world.
// Where there are none, both corners are the position of the node.
std::pair<glm::dvec3, glm::dvec3> box_of_node(const Context& context, uint32_t node);

// The same around the leaves of all performers that are evaluated; nullopt where the boxes of their leaves are not
// known yet.
std::optional<std::pair<glm::dvec3, glm::dvec3>> box_of_performers(const Context& context,
                                                                   const stage::EvaluatedStage& evaluated);

// The eye that sees as a camera of the stage does. It turns about a point at the depth of the performers.
Eye eye_of(const stage::EvaluatedCamera& camera, const stage::Stage& stage, const stage::EvaluatedStage& evaluated);
// Lets the eye fly to where the selected node fills the image, or all performers, where nothing is selected.
void focus(Context& context);
// Adds a camera to the stage that sees what the eye sees.
void remember_view(Context& context);

}  // namespace neuvv::viewer
