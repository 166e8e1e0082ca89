// Handles as lines and polygons in pixels of the image, common to all gizmos: hit tests and construction.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "editor/pointer.h"

namespace neuvv::viewer {

constexpr double kGrab_px = 8;  // a pointer within this distance of a handle can grab it
constexpr size_t kMaxShapePoints = 49;

struct HandleShape {
    int handle = 0;       // a value of the gizmo's enumeration of handles; 0: cannot be grabbed
    glm::vec4 colour{1};  // sRGB and opacity, 0 to 1
    bool filled = false;  // a convex polygon; else a line, which is closed where its last point is its first
    uint32_t count = 0;   // of points
    // x and y in pixels, which may lie outside the image; z is how far behind the gizmo's centre the point lies, in
    // sizes of the gizmo.
    std::array<glm::dvec3, kMaxShapePoints> points{};
};

// The handle within kGrab_px of the pointer that has the least distance in the image; 0: none. To be nearer to the eye
// by the size of the gizmo counts as kFront_px less distance. The inside of a polygon counts as a distance of
// kInside_px, so that lines in front of it can be grabbed.
constexpr double kFront_px = 2, kInside_px = 3;
int handle_at(std::span<const HandleShape> shapes, glm::dvec2 pointer);

// Sorts by depth, the farthest first: the order in which shapes are drawn.
void sort_for_drawing(std::vector<HandleShape>& shapes);

// Converts points of the world to points of shapes: `size_m` in front of `centre` is z = −1, behind it z = 1.
struct ShapeView {
    const stage::Camera& camera;
    double centre_depth, size_m;
    ShapeView(const stage::Camera& of, glm::dvec3 centre, double size)
        : camera(of), centre_depth(editor::depth_of(of, centre)), size_m(size) {}
    std::optional<glm::dvec3> point(glm::dvec3 world) const;  // nullopt: not in front of the camera
};

// A line through points of the world, up to the first one that is not in front of the camera. Nullopt where that leaves
// fewer than two points.
std::optional<HandleShape> line_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                      std::span<const glm::dvec3> world);
// A line that cannot be grabbed: the part of a segment that is in front of the camera, with z = 0. Nullopt: there is
// none.
std::optional<HandleShape> edge_shape(const stage::Camera& camera, glm::vec4 colour, glm::dvec3 a, glm::dvec3 b);
// A filled polygon. Nullopt where a corner is not in front of the camera.
std::optional<HandleShape> polygon_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                         std::span<const glm::dvec3> world);
// A filled square about a point of the world, 2 · half_px wide. Nullopt where the point is not in front of the camera.
std::optional<HandleShape> square_shape(const ShapeView& view, int handle, glm::vec4 colour, glm::dvec3 world,
                                        double half_px);

// Points centre + radius · (u cos φ + v sin φ) for φ from −half_angle to half_angle: an arc about `u`, or, with π, a
// circle. `u` and `v` are unit vectors at right angles.
std::array<glm::dvec3, kMaxShapePoints> arc(glm::dvec3 centre, glm::dvec3 u, glm::dvec3 v, double radius,
                                            double half_angle);

}  // namespace neuvv::viewer
