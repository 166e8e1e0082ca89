// Shapes that are drawn over a stage in a headset, as triangles in the world: controllers, pointer rays, boxes, arcs;
// and holes through which panels are seen.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "xr/pose.h"

namespace neuvv::xr {

struct ShapeVertex {
    glm::vec3 position;  // world, metres
    glm::vec4 colour;    // linear, premultiplied
};

struct TextVertex {
    glm::vec3 position;  // world, metres
    glm::vec4 colour;    // linear, premultiplied
    glm::vec2 uv;        // in the font's image
};

// A part of the font's image.
struct FontPart {
    glm::vec2 low{0}, high{0};  // uv; low is the upper left corner
};

// Collects the shapes of a frame. Positions and sizes are in world metres; colours are linear with straight alpha. A
// shape whose alpha is below 1 is translucent.
class EyeShapes {
  public:
    // Removes all shapes. `eye` is the position (world) from which the shapes are seen: from there a line looks at
    // least `min_width_rad` wide, however far away it is.
    void begin(glm::dvec3 eye, double min_width_rad);

    // Whether the shapes added from here on are seen through the stage as well. A panel hides them where it is nearer,
    // as one that is seen behind something nearer at another depth hurts the eyes. Translucent ones are hidden by all
    // panels.
    void draw_on_top(bool on_top) { drawing_on_top_ = on_top; }

    // The colour is interpolated from one end to the other.
    void line(glm::dvec3 from, glm::dvec3 to, double width_m, glm::vec4 from_colour, glm::vec4 to_colour);
    // Lines from point to point.
    void path(std::span<const glm::dvec3> points, double width_m, glm::vec4 colour);
    // The twelve edges of a box; `low` and `high` are in the space of `world_from_box`.
    void box_edges(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, double width_m, glm::vec4 colour);
    // The faces of a box, shaded a little by their normals.
    void solid_box(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, glm::vec4 colour);
    void ball(glm::dvec3 centre, double radius_m, glm::vec4 colour);
    // A horizontal ellipse with these half axes (world), whose colour is interpolated from its centre to its rim.
    void ellipse(glm::dvec3 centre, glm::dvec3 half_x, glm::dvec3 half_z, glm::vec4 centre_colour,
                 glm::vec4 rim_colour);
    // A horizontal ring, from `radius_m` to `radius_m` + `width_m`.
    void ring(glm::dvec3 centre, double radius_m, double width_m, glm::vec4 colour);
    // A rectangle (X to the right, Y up) where nothing of the stage is seen: the compositor's layer beneath is.
    void hole(const Pose& world_from_rectangle, glm::dvec2 size_m);

    // A rectangle of text: where the part of the font's image covers it, it has the colour. `low` and `high` are its
    // corners in metres on the plane of X (to the right) and Y (up). It is drawn after all other shapes, with a depth
    // test. Of more than kMaxTextRectangles in a frame, those that come last are left out.
    void text(const Pose& world_from_text, glm::dvec2 low, glm::dvec2 high, const FontPart& part, glm::vec4 colour);

    // The corners of triangles, in the order of drawing: later ones cover earlier ones. Those on top come first and
    // have no depth test, so that holes cover them; the solid ones among them are drawn again behind the holes, with a
    // depth test, for where they are nearer than a hole.
    std::span<const ShapeVertex> on_top() const { return on_top_; }
    std::span<const ShapeVertex> holes() const { return holes_; }
    std::span<const ShapeVertex> solid() const { return solid_; }
    std::span<const ShapeVertex> solid_on_top() const { return solid_on_top_; }
    std::span<const ShapeVertex> translucent() const { return translucent_; }
    std::span<const TextVertex> text() const { return text_; }

  private:
    void add(std::span<const ShapeVertex> corners, float alpha);
    void triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::vec4 colour);
    double width_at(glm::dvec3 position, double width_m) const;
    glm::dvec3 eye_{0};
    double min_width_rad_ = 0;
    bool drawing_on_top_ = false;
    std::vector<ShapeVertex> holes_, solid_, translucent_, on_top_, solid_on_top_;
    std::vector<TextVertex> text_;
};
constexpr size_t kMaxTextRectangles = 1024, kTextCorners = 6;

}  // namespace neuvv::xr
