#include "tools/viewer/tools/handle_shape.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::viewer {

namespace {

struct Nearest {
    double distance_px = 0, depth = 0;  // depth as the z of HandleShape::points
};

Nearest nearest_on(const glm::dvec3& a, const glm::dvec3& b, glm::dvec2 pointer) {
    const glm::dvec2 from(a), segment(glm::dvec2(b) - from);
    const double length2 = glm::dot(segment, segment);
    const double part = length2 > 0 ? std::clamp(glm::dot(pointer - from, segment) / length2, 0.0, 1.0) : 0;
    const glm::dvec3 at = glm::mix(a, b, part);
    return {glm::distance(glm::dvec2(at), pointer), at.z};
}

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

bool inside(const HandleShape& shape, glm::dvec2 pointer) {
    bool left = true, right = true;
    for (uint32_t i = 0; i < shape.count; ++i) {
        const glm::dvec2 a(shape.points[i]), b(shape.points[(i + 1) % shape.count]);
        const double side = cross(b - a, pointer - a);
        left &= side >= 0;
        right &= side <= 0;
    }
    return left || right;
}

double centre_depth(const HandleShape& shape) {
    double sum = 0;
    for (uint32_t i = 0; i < shape.count; ++i) sum += shape.points[i].z;
    return sum / shape.count;
}

// The distance of a pointer from a shape as handle_at counts it; INFINITY: too far to grab the shape.
double cost(const HandleShape& shape, glm::dvec2 pointer) {
    if (shape.filled && inside(shape, pointer)) return kInside_px + kFront_px * centre_depth(shape);
    double min = INFINITY;
    const uint32_t lines = shape.filled ? shape.count : shape.count - 1;
    for (uint32_t i = 0; i < lines; ++i) {
        const Nearest nearest = nearest_on(shape.points[i], shape.points[(i + 1) % shape.count], pointer);
        if (nearest.distance_px <= kGrab_px) min = std::min(min, nearest.distance_px + kFront_px * nearest.depth);
    }
    return min;
}

}  // namespace

int handle_at(std::span<const HandleShape> shapes, glm::dvec2 pointer) {
    int found = 0;
    double min_cost = INFINITY;
    for (const HandleShape& shape : shapes) {
        const double shape_cost = shape.handle == 0 || shape.count == 0 ? INFINITY : cost(shape, pointer);
        if (!(shape_cost < min_cost)) continue;
        min_cost = shape_cost;
        found = shape.handle;
    }
    return found;
}

void sort_for_drawing(std::vector<HandleShape>& shapes) {
    std::stable_sort(shapes.begin(), shapes.end(),
                     [](const HandleShape& a, const HandleShape& b) { return centre_depth(a) > centre_depth(b); });
}

std::optional<glm::dvec3> ShapeView::point(glm::dvec3 world) const {
    const std::optional<glm::dvec2> pixel = editor::pixel_of(camera, world);
    if (!pixel) return std::nullopt;
    return glm::dvec3(*pixel, (editor::depth_of(camera, world) - centre_depth) / size_m);
}

std::optional<HandleShape> line_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                      std::span<const glm::dvec3> world) {
    assert(world.size() <= kMaxShapePoints);
    HandleShape shape{handle, colour};
    for (const glm::dvec3& position : world) {
        const std::optional<glm::dvec3> point = view.point(position);
        if (!point) break;
        shape.points[shape.count++] = *point;
    }
    if (shape.count < 2) return std::nullopt;
    return shape;
}

std::optional<HandleShape> edge_shape(const stage::Camera& camera, glm::vec4 colour, glm::dvec3 a, glm::dvec3 b) {
    const auto ends = editor::pixels_of(camera, a, b);
    if (!ends) return std::nullopt;
    HandleShape shape{0, colour, false, 2};
    shape.points[0] = glm::dvec3(ends->first, 0);
    shape.points[1] = glm::dvec3(ends->second, 0);
    return shape;
}

std::optional<HandleShape> polygon_shape(const ShapeView& view, int handle, glm::vec4 colour,
                                         std::span<const glm::dvec3> world) {
    std::optional<HandleShape> shape = line_shape(view, handle, colour, world);
    if (!shape || shape->count != world.size()) return std::nullopt;
    shape->filled = true;
    return shape;
}

std::optional<HandleShape> square_shape(const ShapeView& view, int handle, glm::vec4 colour, glm::dvec3 world,
                                        double half_px) {
    const std::optional<glm::dvec3> centre = view.point(world);
    if (!centre) return std::nullopt;
    HandleShape shape{handle, colour, true, 4};
    for (uint32_t i = 0; i < 4; ++i)
        shape.points[i] = *centre + half_px * glm::dvec3(i == 0 || i == 3 ? -1 : 1, i < 2 ? -1 : 1, 0);
    return shape;
}

std::array<glm::dvec3, kMaxShapePoints> arc(glm::dvec3 centre, glm::dvec3 u, glm::dvec3 v, double radius,
                                            double half_angle) {
    std::array<glm::dvec3, kMaxShapePoints> points{};
    for (size_t i = 0; i < points.size(); ++i) {
        const double angle = half_angle * (2 * static_cast<double>(i) / (kMaxShapePoints - 1) - 1);
        points[i] = centre + radius * (u * std::cos(angle) + v * std::sin(angle));
    }
    return points;
}

}  // namespace neuvv::viewer
