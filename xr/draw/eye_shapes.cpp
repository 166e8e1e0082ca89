#include "xr/draw/eye_shapes.h"

#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace neuvv::xr {

namespace {

glm::vec4 premultiplied(glm::vec4 colour) {
    return {glm::vec3(colour) * colour.a, colour.a};
}

// The shade of a face under a soft light from above and a little from the front (world).
float shade_of(glm::dvec3 normal) {
    const double up = glm::dot(normal, glm::normalize(glm::dvec3(0.2, 1, 0.4)));
    return static_cast<float>(0.62 + 0.38 * up);
}

glm::vec4 shaded(glm::vec4 colour, float shade) {
    return {glm::vec3(colour) * shade, colour.a};
}

// Any unit vector perpendicular to another one.
glm::dvec3 perpendicular_to(glm::dvec3 along) {
    return glm::normalize(glm::cross(along, std::abs(along.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
}

}  // namespace

void EyeShapes::begin(glm::dvec3 eye, double min_width_rad) {
    eye_ = eye;
    min_width_rad_ = min_width_rad;
    holes_.clear();
    solid_.clear();
    translucent_.clear();
    on_top_.clear();
    solid_on_top_.clear();
    text_.clear();
    drawing_on_top_ = false;
}

void EyeShapes::add(std::span<const ShapeVertex> corners, float alpha) {
    const auto append = [&](std::vector<ShapeVertex>& list) {
        list.insert(list.end(), corners.begin(), corners.end());
    };
    if (drawing_on_top_) append(on_top_);
    if (alpha >= 1)
        append(drawing_on_top_ ? solid_on_top_ : solid_);
    else if (!drawing_on_top_)
        append(translucent_);
}

void EyeShapes::triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::vec4 colour) {
    const glm::vec4 drawn = premultiplied(colour);
    add(std::array<ShapeVertex, 3>{{{glm::vec3(a), drawn}, {glm::vec3(b), drawn}, {glm::vec3(c), drawn}}}, colour.a);
}

double EyeShapes::width_at(glm::dvec3 position, double width_m) const {
    return std::max(width_m, min_width_rad_ * glm::distance(position, eye_));
}

// A line is three flat ribbons through its axis, so it is visible from all sides.
void EyeShapes::line(glm::dvec3 from, glm::dvec3 to, double width_m, glm::vec4 from_colour, glm::vec4 to_colour) {
    const double length = glm::distance(from, to);
    if (!(length > 1e-6)) return;
    const glm::dvec3 along = (to - from) / length, x = perpendicular_to(along), y = glm::cross(along, x);
    for (int ribbon = 0; ribbon < 3; ++ribbon) {
        const double angle = ribbon * glm::pi<double>() / 3;
        const glm::dvec3 side = 0.5 * (std::cos(angle) * x + std::sin(angle) * y);
        const glm::dvec3 first = width_at(from, width_m) * side, last = width_at(to, width_m) * side;
        const ShapeVertex a{glm::vec3(from - first), premultiplied(from_colour)},
            b{glm::vec3(from + first), premultiplied(from_colour)}, c{glm::vec3(to + last), premultiplied(to_colour)},
            d{glm::vec3(to - last), premultiplied(to_colour)};
        add(std::array{a, b, c, a, c, d}, std::min(from_colour.a, to_colour.a));
    }
}

void EyeShapes::path(std::span<const glm::dvec3> points, double width_m, glm::vec4 colour) {
    for (size_t i = 1; i < points.size(); ++i) line(points[i - 1], points[i], width_m, colour, colour);
}

namespace {

glm::dvec3 corner_of(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, int corner) {
    const glm::dvec3 at(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    return world_from_box * glm::dvec4(at, 1);
}

}  // namespace

void EyeShapes::box_edges(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, double width_m,
                          glm::vec4 colour) {
    for (int corner = 0; corner < 8; ++corner)
        for (int axis = 1; axis < 8; axis *= 2)
            if (!(corner & axis))
                line(corner_of(world_from_box, low, high, corner), corner_of(world_from_box, low, high, corner | axis),
                     width_m, colour, colour);
}

void EyeShapes::solid_box(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, glm::vec4 colour) {
    const glm::dvec3 centre = world_from_box * glm::dvec4(0.5 * (low + high), 1);
    for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, 1}) {
            const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, first = side << axis;
            glm::dvec3 c[4];
            for (const int i : {0, 1, 2, 3})
                c[i] = corner_of(world_from_box, low, high, first | (i & 1 ? u : 0) | (i & 2 ? v : 0));
            const glm::dvec3 out = 0.5 * (c[0] + c[3]) - centre;
            const glm::vec4 face_colour = shaded(colour, shade_of(out / std::max(glm::length(out), 1e-9)));
            triangle(c[0], c[1], c[3], face_colour);
            triangle(c[0], c[3], c[2], face_colour);
        }
}

void EyeShapes::ball(glm::dvec3 centre, double radius_m, glm::vec4 colour) {
    constexpr int kAround = 16, kDown = 8;
    const auto at = [&](int i, int j) {
        const double theta = glm::pi<double>() * j / kDown, phi = glm::two_pi<double>() * i / kAround;
        return glm::dvec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
    };
    for (int j = 0; j < kDown; ++j)
        for (int i = 0; i < kAround; ++i) {
            const glm::dvec3 a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
            const glm::vec4 face_colour = shaded(colour, shade_of(glm::normalize(a + b + c + d)));
            const auto out = [&](glm::dvec3 normal) { return centre + radius_m * normal; };
            if (j > 0) triangle(out(a), out(b), out(c), face_colour);
            if (j < kDown - 1) triangle(out(a), out(c), out(d), face_colour);
        }
}

void EyeShapes::ellipse(glm::dvec3 centre, glm::dvec3 half_x, glm::dvec3 half_z, glm::vec4 centre_colour,
                        glm::vec4 rim_colour) {
    constexpr int kAround = 32;
    const float alpha = std::min(centre_colour.a, rim_colour.a);
    const auto at = [&](int i) {
        const double phi = glm::two_pi<double>() * i / kAround;
        return ShapeVertex{glm::vec3(centre + std::cos(phi) * half_x + std::sin(phi) * half_z),
                           premultiplied(rim_colour)};
    };
    for (int i = 0; i < kAround; ++i)
        add(std::array<ShapeVertex, 3>{{{glm::vec3(centre), premultiplied(centre_colour)}, at(i), at(i + 1)}}, alpha);
}

void EyeShapes::ring(glm::dvec3 centre, double radius_m, double width_m, glm::vec4 colour) {
    constexpr int kAround = 32;
    const auto at = [&](int i, double radius) {
        const double phi = glm::two_pi<double>() * i / kAround;
        return centre + radius * glm::dvec3(std::cos(phi), 0, std::sin(phi));
    };
    for (int i = 0; i < kAround; ++i) {
        const double outer = radius_m + width_m;
        triangle(at(i, radius_m), at(i + 1, radius_m), at(i + 1, outer), colour);
        triangle(at(i, radius_m), at(i + 1, outer), at(i, outer), colour);
    }
}

void EyeShapes::hole(const Pose& world_from_rectangle, glm::dvec2 size_m) {
    const auto at = [&](double x, double y) {
        return ShapeVertex{glm::vec3(world_from_rectangle * glm::dvec3(0.5 * x * size_m.x, 0.5 * y * size_m.y, 0)),
                           glm::vec4(0)};
    };
    for (const ShapeVertex& corner : {at(-1, -1), at(1, -1), at(1, 1), at(-1, -1), at(1, 1), at(-1, 1)})
        holes_.push_back(corner);
}

void EyeShapes::text(const Pose& world_from_text, glm::dvec2 low, glm::dvec2 high, const FontPart& part,
                     glm::vec4 colour) {
    if (text_.size() >= kTextCorners * kMaxTextRectangles) return;
    text_.reserve(kTextCorners * kMaxTextRectangles);
    for (const glm::dvec2 at : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}}) {
        const glm::dvec2 on_plane = glm::mix(low, high, at);
        const glm::vec2 uv = glm::mix(part.low, part.high, glm::vec2(at.x, 1 - at.y));
        text_.push_back({glm::vec3(world_from_text * glm::dvec3(on_plane, 0)), premultiplied(colour), uv});
    }
}

}  // namespace neuvv::xr
