#include "training/rig/pose_probe.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "training/step/camera_colour.h"

namespace neuvv::training {

namespace {

// Loads the variants of a camera: itself, then each of its numbers changed by a step, up and down. Returns the steps.
PoseChange load_variants(const TrainingStep& step, const PoseProbe& probe, uint32_t camera) {
    const stage::Camera& given = probe.given[camera];
    const PoseChange steps = pose_steps(given, probe.centre, probe.pixels);
    for (size_t variant = 0; variant < kPoseVariants; ++variant) {
        PoseChange change = probe.changes[camera];
        const size_t number = (variant - 1) / 2;
        if (variant > 0) change[number] += (variant % 2 == 1 ? 1 : -1) * steps[number];
        step.rays().cameras.as<ShaderCamera>()[variant] = render::shader_camera(moved(given, change));
    }
    return steps;
}

// What one tile says. `rendered`: the radiance of the tile's variants, one after the other.
void add_tile(const Batch& batch, size_t tile, const glm::vec4* rendered, const CameraColour& colour,
              const PoseChange& steps, PoseEvidence& evidence) {
    for (size_t i = 0; i < kTilePixels; ++i) {
        const glm::vec4 truth = batch.target[tile * kTilePixels + i], behind = batch.background[tile * kTilePixels + i];
        if (truth.a < 0) continue;
        std::array<glm::dvec3, kPoseVariants> colours;
        for (size_t variant = 0; variant < kPoseVariants; ++variant)
            colours[variant] = shown(colour, rendered[variant * kTilePixels + i], behind);
        const glm::dvec3 error = colours[0] - encoded(glm::vec3(truth) + (1 - truth.a) * glm::vec3(behind));
        const double weight = kLargeError / std::max(glm::length(error), kLargeError);
        for (int channel = 0; channel < 3; ++channel) {
            PoseChange derivatives;
            for (size_t number = 0; number < kPoseNumbers; ++number)
                derivatives[number] =
                    (colours[1 + 2 * number][channel] - colours[2 + 2 * number][channel]) / (2 * steps[number]);
            evidence.add(error[channel], derivatives, weight);
        }
    }
}

// Traces tiles `first` to `end` of the batch, all of one camera, for each of its variants.
const glm::vec4* trace_variants(TrainingStep& step, const Batch& batch, size_t first, size_t end, float frame) {
    Tile* tiles = step.rays().tiles.as<Tile>();
    for (size_t tile = first; tile < end; ++tile)
        for (uint32_t variant = 0; variant < kPoseVariants; ++variant) {
            *tiles = batch.tiles[tile];
            (tiles++)->camera = variant;
        }
    return step.trace(frame, static_cast<uint32_t>((end - first) * kPoseVariants), kTrainingStop);
}

}  // namespace

void add_evidence(TrainingStep& step, const PoseProbe& probe, const Batch& batch, float frame,
                  std::vector<PoseEvidence>& evidence) {
    assert(step.rays().camera_capacity >= kPoseVariants && step.rays().tile_capacity >= kPoseVariants);
    assert(batch.samples == 1 && "the tiles count pixels of the camera's own image");
    const size_t at_once = step.rays().tile_capacity / kPoseVariants;
    for (size_t first = 0, end; first < batch.tiles.size(); first = end) {
        const uint32_t camera = batch.tiles[first].camera;
        end = first;
        while (end < batch.tiles.size() && end - first < at_once && batch.tiles[end].camera == camera) ++end;
        const PoseChange steps = load_variants(step, probe, camera);
        const glm::vec4* traced = trace_variants(step, batch, first, end, frame);
        for (size_t tile = first; tile < end; ++tile) {
            const CameraColour colour =
                probe.colours.empty() ? kNeutralColour : probe.colours.of_tile(batch, tile, probe.given[camera]);
            add_tile(batch, tile, traced + (tile - first) * kPoseVariants * kTilePixels, colour, steps,
                     evidence[camera]);
        }
    }
}

}  // namespace neuvv::training
