// Traces rays on the device and by the reference, and compares the results.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include "reference/camera.h"
#include "reference/loss.h"
#include "render/frame/frame_renderer.h"

namespace neuvv::test {

struct Traced {
    std::vector<glm::vec4> radiance;
    std::vector<float> depth;
};

inline Traced trace_on_device(render::FrameRenderer& renderer, const stage::Camera& camera, float frame,
                              render::TraceMode mode, float stop) {
    render::FrameSettings settings;
    settings.instances[0].frame = frame;
    settings.width = camera.width;
    settings.height = camera.height;
    settings.mode = mode;
    settings.stop = stop;
    renderer.render(camera, settings);
    return {renderer.radiance(), renderer.depth()};
}

inline Traced trace_by_reference(const voctree::VOctree& tree, const stage::Camera& camera, double frame, double stop) {
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, frame);
    Traced traced;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const reference::RayResult ray = reference::trace(tree, slices, reference::camera_ray(camera, x, y), stop);
            traced.radiance.emplace_back(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            traced.depth.push_back(static_cast<float>(ray.depth_m));
        }
    return traced;
}

inline Traced shade_by_reference(const voctree::VOctree& tree, const stage::Camera& camera, double frame) {
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, frame);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    Traced traced;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const reference::Ray pixel = reference::camera_ray(camera, x, y);
            const reference::RayResult ray =
                reference::composite(reference::ray_samples_shaded(tree, slices, positions, eye, pixel), 0);
            traced.radiance.emplace_back(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            traced.depth.push_back(static_cast<float>(ray.depth_m));
        }
    return traced;
}

// The largest differences over all pixels.
struct Difference {
    double steps = 0;         // in units of 1/255, of alpha and of sRGB over black
    double depth_m = 0;       // where the truth's alpha is above 1/255
    bool depth_class = true;  // whether depth is infinite exactly where alpha is 0
    double alpha_mean = 0;    // the mean of the truth's alpha
};

// Raises `worst` to `error`; NaN counts as an infinite error.
inline void raise(double& worst, double error) {
    worst = std::isnan(error) ? INFINITY : std::max(worst, error);
}

inline Difference difference(const Traced& traced, const Traced& truth) {
    Difference worst;
    for (size_t i = 0; i < truth.radiance.size(); ++i) {
        const glm::vec4 light = traced.radiance[i], expected = truth.radiance[i];
        for (int channel = 0; channel < 3; ++channel) {
            const double value = reference::display_value(light[channel]);
            const double expected_value = reference::display_value(expected[channel]);
            raise(worst.steps, 255 * std::abs(value - expected_value));
        }
        raise(worst.steps, 255.0 * std::abs(light.a - expected.a));
        worst.depth_class &= std::isinf(traced.depth[i]) == (light.a == 0);
        if (expected.a > 1.0f / 255) raise(worst.depth_m, std::abs(traced.depth[i] - truth.depth[i]));
        worst.alpha_mean += expected.a / static_cast<double>(truth.radiance.size());
    }
    return worst;
}

// The largest permitted difference is one step of 255; on scenes of a few metres rounding alone causes far less.
constexpr double kSteps = 0.1;
constexpr double kDepth_m = 1e-3;
// Slice trees have σ and colour as fp16, with 11 bits: α and sums of SH have errors of up to 1/2000 of the summands.
constexpr double kHalfSteps = 0.5;

inline glm::dvec3 world_of(const voctree::VOctree& tree, glm::dvec3 position) {
    return glm::dvec3(tree.box_min) + position * glm::dvec3(tree.box_size);
}

// How often the frame that was rendered last ran the pass with this name.
inline size_t passes(const render::FrameRenderer& renderer, const std::string& name) {
    const std::vector<gpu::PassTime> times = renderer.pass_times();
    return static_cast<size_t>(
        std::count_if(times.begin(), times.end(), [&](const gpu::PassTime& pass) { return pass.name == name; }));
}

// A transform that rotates by `turn` radians about an oblique axis.
inline glm::mat4 placed(glm::vec3 at, float turn, glm::vec3 scale) {
    return glm::scale(glm::rotate(glm::translate(glm::mat4(1), at), turn, glm::vec3(0.3f, 0.9f, 0.1f)), scale);
}

}  // namespace neuvv::test
