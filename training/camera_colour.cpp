#include "training/camera_colour.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::training {

namespace {

constexpr float kBeta1 = 0.9f, kBeta2 = 0.99f, kEpsilon = 1e-8f;

// The prior's weight, per pixel: λ Σ (number − neutral)². Gains differ more often than channels mix or light is added,
// and where all colours are alike, images cannot tell the one from the other.
constexpr float kGainPrior = 1e-5f, kMixPrior = 0.1f;

// Within these bounds, each element of A's diagonal is larger than the others of its row together, so A has an inverse.
// A camera whose images are black has no gains that could be found; without bounds its inverse would grow without end.
constexpr float kMinGain = 0.5f, kMaxGain = 2, kMaxMix = 0.2f;

glm::vec2 bounds_of(int row, int column) {
    return row == column ? glm::vec2(kMinGain, kMaxGain) : glm::vec2(-kMaxMix, kMaxMix);
}

float prior_of(int row, int column) {
    return row == column ? kGainPrior : kMixPrior;
}

// The mean of all colours becomes neutral.
void centre(std::vector<CameraColour>& colours) {
    for (int row = 0; row < 3; row++) {
        glm::dvec4 sum(0);
        for (const CameraColour& colour : colours) sum += glm::dvec4(colour.rows[row] - kNeutralColour.rows[row]);
        const glm::vec4 mean(sum / static_cast<double>(colours.size()));
        for (CameraColour& colour : colours) colour.rows[row] -= mean;
    }
}

void keep_in_bounds(std::vector<CameraColour>& colours) {
    for (CameraColour& colour : colours)
        for (int row = 0; row < 3; row++)
            for (int i = 0; i < 4; i++) {
                const glm::vec2 bounds = bounds_of(row, i);
                colour.rows[row][i] = std::clamp(colour.rows[row][i], bounds.x, bounds.y);
            }
}

}  // namespace

bool is_bounded(const CameraColour& camera) {
    bool bounded = true;
    for (int row = 0; row < 3; row++)
        for (int i = 0; i < 4; i++) {
            const glm::vec2 bounds = bounds_of(row, i);
            bounded &= camera.rows[row][i] >= bounds.x && camera.rows[row][i] <= bounds.y;
        }
    return bounded;
}

glm::vec3 seen(const CameraColour& camera, glm::vec4 foreground) {
    return {glm::dot(camera.rows[0], foreground), glm::dot(camera.rows[1], foreground),
            glm::dot(camera.rows[2], foreground)};
}

CameraColour inverse(const CameraColour& camera) {
    assert(is_bounded(camera) && "a colour that can be inverted");
    glm::dmat4 affine(1);  // its columns are the rows of the camera
    for (int row = 0; row < 3; row++) affine[row] = camera.rows[row];
    const glm::dmat4 inverted = glm::inverse(affine);
    return {{glm::vec4(inverted[0]), glm::vec4(inverted[1]), glm::vec4(inverted[2])}};
}

glm::vec3 gains(const CameraColour& camera) {
    return {camera.rows[0].r, camera.rows[1].g, camera.rows[2].b};
}

CameraColours::CameraColours(size_t cameras)
    : values(cameras, kNeutralColour), first(cameras, CameraColour{}), second(cameras, CameraColour{}) {}

void CameraColours::learn(const Batch& batch, const CameraColour* tile_gradients, float rate, uint64_t step) {
    if (values.empty()) return;
    std::vector<CameraColour> gradients(values.size(), CameraColour{});
    std::vector<float> pixels(values.size());
    for (size_t tile = 0; tile < batch.tiles.size(); tile++) {
        const uint32_t camera = batch.tiles[tile].camera;
        for (int row = 0; row < 3; row++) gradients[camera].rows[row] += tile_gradients[tile].rows[row];
        pixels[camera] += static_cast<float>(kTilePixels / (batch.samples * batch.samples));
    }
    const double steps = static_cast<double>(step);
    const auto bias1 = static_cast<float>(1 - std::pow(kBeta1, steps));
    const auto bias2 = static_cast<float>(1 - std::pow(kBeta2, steps));
    for (size_t camera = 0; camera < values.size(); camera++) {
        if (pixels[camera] == 0) continue;
        for (int row = 0; row < 3; row++)
            for (int i = 0; i < 4; i++) {
                float& value = values[camera].rows[row][i];
                float& m = first[camera].rows[row][i];
                float& v = second[camera].rows[row][i];
                const float wrong = value - kNeutralColour.rows[row][i];
                const float gradient = gradients[camera].rows[row][i] + 2 * pixels[camera] * prior_of(row, i) * wrong;
                m += (1 - kBeta1) * (gradient - m);
                v += (1 - kBeta2) * (gradient * gradient - v);
                value -= rate * (m / bias1) / (std::sqrt(v / bias2) + kEpsilon);
            }
    }
    centre(values);
    keep_in_bounds(values);
}

}  // namespace neuvv::training
