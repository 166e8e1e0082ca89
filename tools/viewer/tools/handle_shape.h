// What can be grabbed in the image, as lines and polygons in pixels: common to all gizmos.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "editor/pointer.h"

namespace neuvv::viewer {

constexpr double kGrab_px = 8;  // a pointer so near to a handle is on it
constexpr size_t kMaxShapePoints = 49;

struct HandleShape {
    int handle = 0;       // of the gizmo's own enumeration; 0 is drawn and cannot be grabbed
    glm::vec4 colour{1};  // sRGB and opacity, 0 to 1
    bool filled = false;  // a convex polygon; else an open line: a closed one ends with its first point
    uint32_t count = 0;
    // x, y in pixels; z says how far behind the gizmo's middle it is, in sizes of the gizmo. May lie out of the
    // image.
    std::array<glm::dvec3, kMaxShapePoints> points{};
};

// The handle within kGrab_px of the pointer, the nearest one in the image. Being a gizmo's size nearer to the eye
// counts as much as kFront_px; the inside of a polygon as kInside_px away, so that lines before it can be grabbed. 0:
// none.
constexpr double kFront_px = 2, kInside_px = 3;
int handle_at(std::span<const HandleShape> shapes, glm::dvec2 pointer);

// The farthest first, as they are drawn.
void sort_for_drawing(std::vector<HandleShape>& shapes);

// From world to the points of shapes: `size_m` in front of or behind `middle` is z = ∓1.
struct ShapeView {
    const stage::Camera& camera;
    double middle_depth, size_m;
    ShapeView(const stage::Camera& of, glm::dvec3 middle, double size)
        : camera(of), middle_depth(editor::depth_of(of, middle)), size_m(size) {}
    std::optional<glm::dvec3> point(glm::dvec3 world) const;
};

// Lines through so many points; the part before the first one that is behind the camera. Nothing under two points.
std::optional<HandleShape> line_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                      std::span<const glm::dvec3> world);
// The part of a segment that is in front of the camera, at the middle's depth.
std::optional<HandleShape> edge_shape(const stage::Camera& camera, glm::vec4 colour, glm::dvec3 a, glm::dvec3 b);
// All of it, or nothing where a corner is behind the camera.
std::optional<HandleShape> polygon_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                         std::span<const glm::dvec3> world);
// A square about a point, `half_px` to each side.
std::optional<HandleShape> square_shape(const ShapeView& view, int handle, glm::vec4 colour, glm::dvec3 world,
                                        double half_px);

// A circle, or the arc from −`half_angle` to +`half_angle` about `u`: middle + radius (u cos φ + v sin φ).
std::array<glm::dvec3, kMaxShapePoints> arc(glm::dvec3 middle, glm::dvec3 u, glm::dvec3 v, double radius,
                                            double half_angle);

}  // namespace neuvv::viewer
