// What is drawn over a stage in a headset, as triangles in the world: controllers, pointing rays, boxes, arcs; and
// holes through which panels are seen.
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "xr/pose.h"

namespace neuvv::xr {

struct ShapeVertex {
    glm::vec3 place;   // world, metres
    glm::vec4 colour;  // linear, premultiplied
};

class EyeShapes {
  public:
    // Seen from here (world): lines stay so many radians wide at least, however far.
    void begin(glm::dvec3 eye, double least_width_rad);

    // Whether what is drawn from here on is seen through all that is before it, stage and panels too. Over all else.
    void see_through(bool through) { through_ = through; }

    // Of one colour (linear, straight alpha); lines are as wide as that many metres. Solid ones where alpha is 1.
    void line(glm::dvec3 from, glm::dvec3 to, double width_m, glm::vec4 from_colour, glm::vec4 to_colour);
    void path(std::span<const glm::dvec3> points, double width_m, glm::vec4 colour);
    // A box's edges; of a box in the space of `world_from_box`.
    void box_edges(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, double width_m, glm::vec4 colour);
    // Shaded a little by how its faces stand.
    void solid_box(const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high, glm::vec4 colour);
    void ball(glm::dvec3 middle, double radius_m, glm::vec4 colour);
    // Flat on the floor.
    void ring(glm::dvec3 middle, double radius_m, double width_m, glm::vec4 colour);
    // Nothing of the stage is seen there, and the layer beneath is (a rectangle's X to the right, Y up).
    void hole(const Pose& world_from_rectangle, glm::dvec2 size_m);

    std::span<const ShapeVertex> holes() const { return holes_; }
    std::span<const ShapeVertex> solid() const { return solid_; }
    // Later ones over earlier ones.
    std::span<const ShapeVertex> clear_ones() const { return clear_; }
    std::span<const ShapeVertex> through_ones() const { return through_ones_; }

  private:
    std::vector<ShapeVertex>& list_of(float alpha);
    void triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, glm::vec4 colour);
    double width_at(glm::dvec3 place, double width_m) const;
    glm::dvec3 eye_{0};
    double least_width_rad_ = 0;
    bool through_ = false;
    std::vector<ShapeVertex> holes_, solid_, clear_, through_ones_;
};

}  // namespace neuvv::xr
