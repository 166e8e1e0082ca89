// The cameras of a capture: a dome of four rings around the performer. All cameras look at the dome's centre.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stage/camera.h"

namespace neuvv::training {

// Rings from the equator to the top, as in the paper's dome. The longer a ring, the more cameras it has.
constexpr uint32_t kRings = 4;
constexpr std::array<double, kRings> kRingElevation_deg = {0, 20, 42, 66};

struct DomeCamera {
    uint32_t ring = 0;
    glm::dvec3 outward{0};            // unit, from the centre to the camera
    glm::dmat3 world_from_camera{1};  // OpenGL axes
};

// A camera of a ring; angles in radians, the azimuth from +Z over +X.
DomeCamera dome_camera(uint32_t ring, double azimuth, double elevation);
// `count` cameras, ring by ring from the equator; neighbouring rings are staggered.
std::vector<DomeCamera> dome_cameras(uint32_t count);

// Which of `count` cameras, in the order of dome_cameras, are held out for the test: a share of them, rounded, spread
// evenly over the rings and around them. At least one camera is held out and at least one is not; with a share of 0
// none is held out. With a share above 0, count must be at least 2 (assert).
std::vector<bool> held_out(uint32_t count, double share);

// The smallest dome in which every camera sees every point. All cameras have the same lens.
struct DomeFit {
    glm::dvec3 centre{0};  // world, metres
    glm::dvec2 focal{1};   // focal length in half widths and in half heights of the image
    double margin = 0;     // between the points and the image's border, as a share of half the image
    double radius = 0;     // of the dome, metres
};
// A dome of radius 0 whose cameras have an angle of view of 30° along the image's shorter side and a margin of 4 %.
DomeFit dome_fit(const glm::dvec3& centre, uint32_t width, uint32_t height);
// Enlarges the radius, where necessary, until every camera sees these points (world, metres).
void include_points(DomeFit& fit, const std::vector<DomeCamera>& dome, const std::vector<glm::vec3>& points);

stage::Camera make_camera(const DomeCamera& camera, const DomeFit& fit, uint32_t width, uint32_t height);

}  // namespace neuvv::training
