#include "training/rig/time_probe.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::training {

namespace {

// What tiles `first` to `end` of the batch show at a frame, by ray.
std::vector<glm::vec4> traced(TrainingStep& step, const Batch& batch, size_t first, size_t end, uint32_t frame) {
    std::copy_n(batch.tiles.begin() + static_cast<ptrdiff_t>(first), end - first, step.rays().tiles.as<Tile>());
    const glm::vec4* rays = step.trace(static_cast<float>(frame), static_cast<uint32_t>(end - first), kTrainingStop);
    return {rays, rays + (end - first) * kTilePixels};
}

double absolute_difference(glm::dvec3 a, glm::dvec3 b) {
    return glm::dot(glm::abs(a - b), glm::dvec3(1));
}

}  // namespace

double TimeEvidence::frames_late() const {
    if (next.motion <= 0 || previous.motion <= 0) return 0;
    const double forwards = (next.own - next.beside) / next.motion;
    const double backwards = (previous.own - previous.beside) / previous.motion;
    return std::clamp(0.5 * (forwards - backwards), -1.0, 1.0);
}

double TimeEvidence::contrast() const {
    const double own = next.own + previous.own;
    if (next.motion <= 0 || previous.motion <= 0) return 0;
    return own > 0 ? (next.motion + previous.motion) / own : 0;
}

void add_time_evidence(TrainingStep& step, const std::vector<stage::Camera>& cameras, const CameraColours& colours,
                       const Batch& batch, uint32_t frame, uint32_t beside, std::vector<TimeEvidence>& evidence) {
    assert(step.rays().camera_capacity >= cameras.size() && batch.samples == 1);
    for (size_t i = 0; i < cameras.size(); ++i)
        step.rays().cameras.as<ShaderCamera>()[i] = render::shader_camera(cameras[i]);
    for (size_t first = 0, end; first < batch.tiles.size(); first = end) {
        end = std::min<size_t>(first + step.rays().tile_capacity, batch.tiles.size());
        const std::vector<glm::vec4> here = traced(step, batch, first, end, frame);
        const std::vector<glm::vec4> there = traced(step, batch, first, end, beside);
        for (size_t i = 0; i < here.size(); ++i) {
            const size_t ray = first * kTilePixels + i, tile = ray / kTilePixels;
            const glm::vec4 truth = batch.target[ray], behind = batch.background[ray];
            if (truth.a < 0) continue;
            const uint32_t camera = batch.tiles[tile].camera;
            const CameraColour colour =
                colours.empty() ? kNeutralColour : colours.of_tile(batch, tile, cameras[camera]);
            const glm::dvec3 photographed = encoded(glm::vec3(truth) + (1 - truth.a) * glm::vec3(behind));
            TimeEvidence::Sums& sums = beside > frame ? evidence[camera].next : evidence[camera].previous;
            const glm::dvec3 now = shown(colour, here[i], behind), then = shown(colour, there[i], behind);
            sums.own += absolute_difference(photographed, now);
            sums.beside += absolute_difference(photographed, then);
            sums.motion += absolute_difference(now, then);
        }
    }
}

}  // namespace neuvv::training
