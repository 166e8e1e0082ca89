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

size_t band_of(const stage::Camera& camera, uint32_t row) {
    return std::min<size_t>(size_t{row} * kRowBands / camera.height, kRowBands - 1);
}

TimeEvidence::Sums sum_of(const TimeEvidence::Bands& bands) {
    TimeEvidence::Sums sum;
    for (const TimeEvidence::Sums& band : bands) sum += band;
    return sum;
}

double late_by(const TimeEvidence::Sums& next, const TimeEvidence::Sums& previous) {
    if (next.motion <= 0 || previous.motion <= 0) return 0;
    return std::clamp(next.along / next.motion - previous.along / previous.motion, -1.0, 1.0);
}

}  // namespace

TimeEvidence::Sums& TimeEvidence::Sums::operator+=(const Sums& other) {
    along += other.along;
    motion += other.motion;
    error += other.error;
    return *this;
}

double TimeEvidence::frames_late() const {
    return late_by(sum_of(next), sum_of(previous));
}

// A line through how late bands are, each with its motion as its weight.
Readout TimeEvidence::readout() const {
    double weights = 0, squared_weights = 0, row = 0, late = 0, row_row = 0, row_late = 0, late_late = 0;
    for (size_t band = 0; band < kRowBands; ++band) {
        const double weight = std::min(next[band].motion, previous[band].motion);
        if (weight <= 0) continue;
        const double x = (static_cast<double>(band) + 0.5) / kRowBands, y = late_by(next[band], previous[band]);
        weights += weight;
        squared_weights += weight * weight;
        row += weight * x;
        late += weight * y;
        row_row += weight * x * x;
        row_late += weight * x * y;
        late_late += weight * y * y;
    }
    const double equal_bands = weights > 0 ? weights * weights / squared_weights : 0;  // as many say as much
    if (equal_bands < kLeastBands) return {};
    const double mean_row = row / weights, mean_late = late / weights;
    const double spread = row_row / weights - mean_row * mean_row;
    const double slope = (row_late / weights - mean_row * mean_late) / spread;
    const double off_line = std::max(late_late / weights - mean_late * mean_late - slope * slope * spread, 0.0);
    return {slope, std::sqrt(off_line / spread / (equal_bands - 2))};
}

double TimeEvidence::blur() const {
    const Sums after = sum_of(next), before = sum_of(previous);
    if (after.motion <= 0 || before.motion <= 0) return 0;
    return 8 * std::min(after.along / after.motion, before.along / before.motion);
}

double TimeEvidence::contrast() const {
    const Sums after = sum_of(next), before = sum_of(previous);
    const double error = after.error + before.error;
    if (after.motion <= 0 || before.motion <= 0 || error <= 0) return 0;
    return std::sqrt((after.motion + before.motion) / error);
}

TimeEvidence& TimeEvidence::operator+=(const TimeEvidence& other) {
    for (size_t band = 0; band < kRowBands; ++band) {
        next[band] += other.next[band];
        previous[band] += other.previous[band];
    }
    return *this;
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
            const glm::dvec3 now = shown(colour, here[i], behind), motion = shown(colour, there[i], behind) - now;
            TimeEvidence::Bands& bands = beside > frame ? evidence[camera].next : evidence[camera].previous;
            TimeEvidence::Sums& sums =
                bands[band_of(cameras[camera], batch.tiles[tile].y + static_cast<uint32_t>(i % kTilePixels / kTile))];
            sums.along += glm::dot(photographed - now, motion);
            sums.motion += glm::dot(motion, motion);
            sums.error += glm::dot(photographed - now, photographed - now);
        }
    }
}

}  // namespace neuvv::training
