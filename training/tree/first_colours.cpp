#include "training/tree/first_colours.h"

#include <algorithm>

#include "base/threads/parallel.h"
#include "base/trace_file.h"

namespace neuvv::training {

namespace {

constexpr size_t kTimes = 6;  // evenly spread over the clip; a few are enough for a first guess

// What a view shows at a position, weighted by its matte: (α c, α).
glm::vec4 colour_seen_at(const Dataset& dataset, const View& view, const glm::dmat4& camera_from_world,
                         glm::vec3 position) {
    const stage::Camera& camera = dataset.cameras[view.camera];
    const glm::dvec4 p = camera_from_world * glm::dvec4(glm::dvec3(position), 1);
    if (p.z >= 0) return glm::vec4(0);
    const double x = camera.cx - camera.fx * p.x / p.z, y = camera.cy + camera.fy * p.y / p.z;
    if (!(x >= 0 && y >= 0 && x < camera.width && y < camera.height)) return glm::vec4(0);
    return foreground(dataset, view, static_cast<uint32_t>(x), static_cast<uint32_t>(y));
}

}  // namespace

std::vector<glm::vec3> first_colours(const Dataset& dataset, const std::vector<glm::vec3>& positions,
                                     const std::vector<uint32_t>& allowed) {
    const TraceSpan span("first colours");
    const size_t times = dataset.times.size(), words = (times + 31) / 32;
    std::vector<glm::vec4> sums(positions.size(), glm::vec4(0));
    for (size_t i = 0; i < std::min(kTimes, times); ++i) {
        const size_t t = i * times / std::min(kTimes, times);
        for (const View& view : dataset.views) {
            if (view.time != dataset.times[t]) continue;
            const glm::dmat4 camera_from_world = glm::inverse(dataset.cameras[view.camera].world_from_camera);
            parallel_for(positions.size(), 4096, [&](size_t begin, size_t end) {
                for (size_t k = begin; k < end; ++k)
                    if (allowed[k * words + t / 32] >> t % 32 & 1)
                        sums[k] += colour_seen_at(dataset, view, camera_from_world, positions[k]);
            });
        }
    }
    std::vector<glm::vec3> colours(positions.size());
    for (size_t k = 0; k < positions.size(); ++k)
        colours[k] = sums[k].a > 0 ? glm::vec3(sums[k]) / sums[k].a : glm::vec3(0.5f);
    return colours;
}

}  // namespace neuvv::training
