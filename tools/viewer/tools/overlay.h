// What is drawn over the image, and questions of tools about the image: common to all tools.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>

#include "tools/viewer/context.h"
#include "tools/viewer/tools/handle_shape.h"

namespace neuvv::viewer {

// The floor of lines, icons of lights and cameras, and the box of what is selected.
void draw_scene_overlay(const Context& context);
// Handles; `hot` is the one that is dragged or under the pointer, 0: none.
void draw_handles(const Context& context, std::span<const HandleShape> shapes, int hot);

// The node of the light or camera whose icon is at a position of the window; none.
std::optional<uint32_t> icon_at(const Context& context, float x, float y);
// The pointer in pixels of the image.
glm::dvec2 pointer_of(const Context& context);
// The world box of a node and of its descendants, low and high: of their performers and meshes; the node's position
// where there are none.
std::pair<glm::dvec3, glm::dvec3> box_of_node(const Context& context, uint32_t node);

// The eye moves so that the selection fills the image, or all performers where nothing is selected.
void focus(Context& context);
// Adds a camera to the stage that sees what the eye sees.
void remember_view(Context& context);

}  // namespace neuvv::viewer
