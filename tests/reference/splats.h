// Gaussian splats as "3D Gaussian Splatting for Real-Time Radiance Field Rendering" defines them (Kerbl et al. 2023),
// in the form of that work's .ply, drawn pixel by pixel.
#pragma once

#include <array>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

namespace neuvv::reference {

struct GaussianSplat {
    glm::dvec3 position;
    glm::dvec3 scale;     // standard deviations
    glm::dquat rotation;  // w, x, y, z
    double opacity = 0;
    std::vector<glm::dvec3> sh;  // by l² + l + m
};

// Reads a binary .ply, whatever order its properties have; adds a test failure where it is none.
std::vector<GaussianSplat> read_splats(const std::filesystem::path& file);

// A camera with the axes of such files: x to the right, y down, z forward. Pixel centres are at +0.5.
struct SplatCamera {
    glm::dmat3 camera_from_world;
    glm::dvec3 position;
    double fx, fy, cx, cy;
    int width, height;
};
// Pixels row by row, encoded as the splats' colours are, on a background.
std::vector<glm::dvec3> draw_splats(std::vector<GaussianSplat> splats, const SplatCamera& camera,
                                    const glm::dvec3& background);

}  // namespace neuvv::reference
