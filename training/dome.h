// The capture stage's cameras: a dome of four rings around the performer, all looking at its centre.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "stage/camera.h"

namespace neuvv::training {

// From the equator to the top, as in the paper's dome. Rings hold cameras in proportion to their circumference.
constexpr uint32_t kRings = 4;
constexpr std::array<double, kRings> kRingElevation_deg = {0, 20, 42, 66};

struct DomeCamera {
    uint32_t ring = 0;
    glm::dvec3 outward{0};            // unit, from the centre to the camera
    glm::dmat3 world_from_camera{1};  // OpenGL axes
};

// Ring by ring from the equator; neighbouring rings are staggered.
std::vector<DomeCamera> dome_cameras(uint32_t count);

// Of `count` cameras in dome order, which are held out: a share, rounded, at least one of each kind, evenly spread over
// the rings and around them; none for a share of 0. With a share, count must be 2 at least (assert).
std::vector<bool> held_out(uint32_t count, double share);

// Grows the smallest radius at which every point is in every camera's image. The lenses are alike: `focal` in half
// widths and half heights of the image, the points kept `margin` (a share of the half) away from its border.
struct DomeFit {
    glm::dvec3 centre{0};
    glm::dvec2 focal{1};
    double margin = 0;
    double radius = 0;
};
void include_points(DomeFit& fit, const std::vector<DomeCamera>& dome, const std::vector<glm::vec3>& points);

stage::Camera make_camera(const DomeCamera& camera, const DomeFit& fit, uint32_t width, uint32_t height);

}  // namespace neuvv::training
