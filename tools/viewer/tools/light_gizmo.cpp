#include "tools/viewer/tools/light_gizmo.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::viewer {

namespace {

using std::numbers::pi;
constexpr double kAlong = 0.7;  // cosine of the angle between light and view above which the eye looks along the light
constexpr double kMinAimDistance_m = 1e-3;
constexpr double kMinHeight = 0.3;  // distance of the plane across a wide cone from the light, in distances of the aim
constexpr double kInnerShare = 0.99;  // the inner cone's share of the outer one, where it has to follow
constexpr double kSquare_px = 5;

// The geometry of the cone that shapes and drags have in common. World space.
struct Cone {
    glm::dvec3 direction{0}, to_eye{0}, side{0};  // unit; `side` is across the other two and points at the outline
    double aim_distance_m = 0;
    bool along = false;  // the eye looks along the light

    explicit Cone(const LightGizmo& gizmo) {
        const AimedLight& light = gizmo.light;
        direction = light.direction();
        aim_distance_m = glm::distance(light.aim, light.position);
        to_eye = glm::normalize(glm::dvec3(gizmo.camera.world_from_camera[3]) - light.aim);
        along = std::abs(glm::dot(direction, to_eye)) > kAlong;
        const glm::dvec3 across = glm::cross(direction, to_eye);
        side = glm::length(across) > 1e-6 ? glm::normalize(across) : editor::perpendicular_to(direction);
    }
    glm::dvec3 rim(const AimedLight& light, glm::dvec3 across) const {
        return light.position +
               aim_distance_m * (direction * std::cos(light.outer_cone_rad) + across * std::sin(light.outer_cone_rad));
    }
};

bool is_valid(const AimedLight& light) {
    const double aim_distance_m = glm::distance(light.aim, light.position);
    return aim_distance_m >= kMinAimDistance_m && std::isfinite(aim_distance_m) &&
           std::isfinite(glm::length(light.position));
}

struct LightShapes {
    const LightGizmo& gizmo;
    const AimedLight& light;
    Cone cone;
    ShapeView view;
    std::vector<HandleShape> all;

    explicit LightShapes(const LightGizmo& of)
        : gizmo(of), light(of.light), cone(of), view(of.camera, of.light.aim, cone.aim_distance_m) {
        all.reserve(16);
    }
    void add(const std::optional<HandleShape>& shape) {
        if (shape) all.push_back(*shape);
    }
    void add_square(LightHandle handle, glm::dvec3 at) {
        add(square_shape(view, static_cast<int>(handle), gizmo.colour, at, kSquare_px));
    }
    void add_edge(glm::dvec3 to) { add(edge_shape(gizmo.camera, gizmo.colour, light.position, to)); }
    void add_circle(LightHandle handle, glm::dvec3 centre, glm::dvec3 normal, glm::dvec3 u, double radius_m) {
        const auto points = arc(centre, u, glm::cross(normal, u), radius_m, pi);
        add(line_shape(view, static_cast<int>(handle), gizmo.colour, points));
    }
};

double outer_cone(const LightGizmo& gizmo, glm::dvec2 from, glm::dvec2 to, bool snap) {
    const AimedLight& light = gizmo.light;
    const Cone cone(gizmo);
    const double height = std::max(std::cos(light.outer_cone_rad), kMinHeight) * cone.aim_distance_m;
    const glm::dvec3 through = cone.along ? light.position + cone.direction * height : light.position;
    const glm::dvec3 normal = cone.along ? cone.direction : glm::cross(cone.direction, cone.side);
    const auto angle = [&](glm::dvec2 pointer) -> std::optional<double> {
        const std::optional<glm::dvec3> at = editor::plane_drag(gizmo.camera, through, normal, pointer);
        if (!at) return std::nullopt;
        const glm::dvec3 away = *at - light.position;
        const double ahead = glm::dot(away, cone.direction);
        return std::atan2(glm::length(away - cone.direction * ahead), ahead);
    };
    const std::optional<double> before = angle(from), after = angle(to);
    if (!before || !after) return light.outer_cone_rad;
    const double degree = pi / 180, turned = light.outer_cone_rad + *after - *before;
    return std::clamp(editor::snapped(turned, kConeSnap_deg * degree, snap),
                      (snap ? kConeSnap_deg : kMinCone_deg) * degree, pi / 2);
}

double range(const LightGizmo& gizmo, glm::dvec2 from, glm::dvec2 to, bool snap) {
    const AimedLight& light = gizmo.light;
    const auto fraction = [&](glm::dvec2 pointer) -> std::optional<double> {
        if (light.kind != stage::GltfLightKind::kPoint) {
            const glm::dvec3 along = light.direction() * light.range_m;
            return editor::line_drag(gizmo.camera, light.position + along, along, 1, pointer);
        }
        const glm::dvec3 to_eye = glm::dvec3(gizmo.camera.world_from_camera[3]) - light.position;
        const std::optional<glm::dvec3> at = editor::plane_drag(gizmo.camera, light.position, to_eye, pointer);
        if (!at) return std::nullopt;
        return glm::distance(*at, light.position) / light.range_m;
    };
    const std::optional<double> before = fraction(from), after = fraction(to);
    if (!before || !after) return light.range_m;
    const double range_m = editor::snapped(light.range_m * (1 + *after - *before), kRangeSnap_m, snap);
    return std::max(range_m, snap ? kRangeSnap_m : kMinRange_m);
}

glm::dvec3 aim(const LightGizmo& gizmo, glm::dvec2 from, glm::dvec2 to, bool snap) {
    const stage::Camera& camera = gizmo.camera;
    const AimedLight& light = gizmo.light;
    if (editor::depth_of(camera, light.aim) < editor::kMinDepth_m) return light.aim;
    const std::optional<glm::dvec3> before = editor::plane_drag(camera, light.aim, editor::facing_normal(camera), from),
                                    after = editor::plane_drag(camera, light.aim, editor::facing_normal(camera), to);
    if (!before || !after) return light.aim;
    const glm::dvec3 right = camera.world_from_camera[0], up = camera.world_from_camera[1], move = *after - *before;
    const glm::dvec3 aimed = light.aim + right * editor::snapped(glm::dot(move, right), kAimSnap_m, snap) +
                             up * editor::snapped(glm::dot(move, up), kAimSnap_m, snap);
    return glm::distance(aimed, light.position) >= kMinAimDistance_m ? aimed : light.aim;
}

}  // namespace

AimedLight aimed_light(const stage::EvaluatedLight& light, double aim_distance_m) {
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, 0.0, 1.0)); };
    return {light.kind,
            light.position,
            light.position + light.direction * aim_distance_m,
            angle(light.cos_outer),
            angle(light.cos_inner),
            light.range_m};
}

std::vector<HandleShape> light_shapes(const LightGizmo& gizmo) {
    const AimedLight& light = gizmo.light;
    if (!is_valid(light)) return {};
    LightShapes shapes(gizmo);
    const Cone& cone = shapes.cone;
    if (light.kind == stage::GltfLightKind::kPoint) {
        const glm::dvec3 to_eye = glm::normalize(glm::dvec3(gizmo.camera.world_from_camera[3]) - light.position);
        if (light.range_m > 0)
            shapes.add_circle(LightHandle::kRange, light.position, to_eye, editor::perpendicular_to(to_eye),
                              light.range_m);
        return std::move(shapes.all);
    }
    shapes.add_edge(light.aim);
    shapes.add_square(LightHandle::kAim, light.aim);
    if (light.kind == stage::GltfLightKind::kSpot) {
        const glm::dvec3 ends[] = {cone.rim(light, cone.side), cone.rim(light, -cone.side)};
        for (const glm::dvec3& end : ends) {
            shapes.add_edge(end);
            shapes.add_square(LightHandle::kRim, end);
        }
        shapes.add_circle(cone.along ? LightHandle::kRim : LightHandle::kNone, (ends[0] + ends[1]) / 2.0,
                          cone.direction, cone.side, glm::distance(ends[0], ends[1]) / 2);
        const glm::dvec3 far = light.position + cone.direction * light.range_m;
        if (light.range_m > 0) {
            shapes.add_edge(far);
            shapes.add_square(LightHandle::kRange, far);
        }
    }
    sort_for_drawing(shapes.all);
    return std::move(shapes.all);
}

LightHandle light_handle_at(const LightGizmo& gizmo, glm::dvec2 pointer) {
    return static_cast<LightHandle>(handle_at(light_shapes(gizmo), pointer));
}

AimedLight dragged(const LightGizmo& gizmo, LightHandle handle, glm::dvec2 from, glm::dvec2 to, bool snap) {
    AimedLight light = gizmo.light;
    if (!is_valid(light) || !editor::is_valid_pointer(from) || !editor::is_valid_pointer(to)) return light;
    switch (handle) {
        case LightHandle::kNone:
            break;
        case LightHandle::kAim:
            light.aim = aim(gizmo, from, to, snap);
            break;
        case LightHandle::kRim:
            light.outer_cone_rad = outer_cone(gizmo, from, to, snap);
            light.inner_cone_rad = std::min(light.inner_cone_rad, kInnerShare * light.outer_cone_rad);
            break;
        case LightHandle::kRange:
            if (light.range_m > 0) light.range_m = range(gizmo, from, to, snap);
            break;
    }
    return light;
}

}  // namespace neuvv::viewer
