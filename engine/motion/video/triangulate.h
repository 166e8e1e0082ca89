// Joints of one frame from key points of several views.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "motion/video/key_points.h"

namespace neuvv::motion {

// Where a camera shows a point of its world, in pixels; nullopt: the point is not in front of it.
std::optional<glm::dvec2> project(const stage::Camera& camera, const glm::dvec3& point);
// How many metres at the point are a pixel of the camera.
double metres_per_pixel(const stage::Camera& camera, const glm::dvec3& point);

// The point nearest to the cameras' optical axes: what they look at. nullopt where the axes are parallel.
std::optional<glm::dvec3> point_looked_at(std::span<const stage::Camera> cameras);

// The median size of a body in the images, at the point that the cameras look at; an adult's where they look at none.
// `points`: frames × cameras.
double guessed_height(std::span<const stage::Camera> cameras, std::span<const KeyPoints> points);

struct Triangulated {
    glm::dvec3 position{0};
    std::vector<bool> agrees;  // by camera: the key point is nearer than the tolerance
    size_t views = 0;          // that agree
    double confidence = 0;     // the mean of those that agree
};

// RANSAC over all pairs of views: the point that most views agree with, then the mean of their rays. `points` has the
// joint's key point by camera. nullopt where no two views agree within the tolerance (metres).
std::optional<Triangulated> triangulate(std::span<const stage::Camera> cameras, std::span<const KeyPoint> points,
                                        double tolerance_m);

}  // namespace neuvv::motion
