#include "training/step/camera_colour.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "media/image.h"

namespace neuvv::training {

namespace {

constexpr float kBeta1 = 0.9f, kBeta2 = 0.99f, kEpsilon = 1e-8f;

// The prior's weight, per pixel: λ Σ (number − neutral)². Gains differ more often than channels mix or light is added,
// and where all colours are alike, images cannot tell the one from the other.
constexpr float kGainPrior = 1e-5f, kMixPrior = 0.1f;

// Vignettes of 30 % at corners are common; a performer who stays in the middle of an image says little of them.
constexpr float kVignettePrior = 1e-5f;

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
    for (int row = 0; row < 3; ++row) {
        glm::dvec4 sum(0);
        for (const CameraColour& colour : colours) sum += glm::dvec4(colour.rows[row] - kNeutralColour.rows[row]);
        const glm::vec4 mean(sum / static_cast<double>(colours.size()));
        for (CameraColour& colour : colours) colour.rows[row] -= mean;
    }
}

void keep_in_bounds(std::vector<CameraColour>& colours) {
    for (CameraColour& colour : colours)
        for (int row = 0; row < 3; ++row)
            for (int i = 0; i < 4; ++i) {
                const glm::vec2 bounds = bounds_of(row, i);
                colour.rows[row][i] = std::clamp(colour.rows[row][i], bounds.x, bounds.y);
            }
}

void keep_in_bounds(LearntNumbers& numbers, float most) {
    for (float& value : numbers.values) value = std::clamp(value, -most, most);
}

// The mean over cameras of one of the numbers that each camera has becomes 0. Numbers that no image has moved, as there
// is none, do not count and stay 0.
void centre(LearntNumbers& numbers, size_t number, size_t per_camera) {
    float sum = 0, count = 0;
    for (size_t i = number; i < numbers.values.size(); i += per_camera)
        if (numbers.second[i] > 0) sum += numbers.values[i], count++;
    for (size_t i = number; i < numbers.values.size(); i += per_camera)
        if (numbers.second[i] > 0) numbers.values[i] -= sum / count;
}

glm::vec2 vignette_of(const LearntNumbers& vignettes, size_t camera) {
    return {vignettes.values[2 * camera], vignettes.values[2 * camera + 1]};
}

// The squared distance of a tile's middle from the principal point; 1 at the farthest corner of the image.
float radius_squared(const Batch& batch, size_t tile, const stage::Camera& camera) {
    const glm::dvec2 middle =
        (glm::dvec2(batch.tiles[tile].x, batch.tiles[tile].y) + 0.5 * kTile) / double(batch.samples);
    const glm::dvec2 principal(camera.cx, camera.cy), size(camera.width, camera.height);
    const glm::dvec2 corner = glm::max(principal, size - principal);
    const glm::dvec2 from = middle - principal;
    return static_cast<float>(glm::dot(from, from) / glm::dot(corner, corner));
}

// A step of Adam. The step is that of the run, also for a number that moves in some steps only: its second moment then
// lags behind the first, and it moves up to about twice as far in its first updates.
class Adam {
  public:
    Adam(float rate, uint64_t step)
        : rate_(rate),
          bias1_(static_cast<float>(1 - std::pow(kBeta1, static_cast<double>(step)))),
          bias2_(static_cast<float>(1 - std::pow(kBeta2, static_cast<double>(step)))) {}

    void move(float& value, float& first, float& second, float gradient) const {
        first += (1 - kBeta1) * (gradient - first);
        second += (1 - kBeta2) * (gradient * gradient - second);
        value -= rate_ * (first / bias1_) / (std::sqrt(second / bias2_) + kEpsilon);
    }
    // The same for a number that a prior of this weight pulls towards 0.
    void move(LearntNumbers& numbers, size_t i, float gradient, float prior) const {
        move(numbers.values[i], numbers.first[i], numbers.second[i], gradient + 2 * prior * numbers.values[i]);
    }

  private:
    float rate_, bias1_, bias2_;
};

}  // namespace

bool is_bounded(const CameraColour& camera) {
    bool bounded = true;
    for (int row = 0; row < 3; ++row)
        for (int i = 0; i < 4; ++i) {
            const glm::vec2 bounds = bounds_of(row, i);
            bounded &= camera.rows[row][i] >= bounds.x && camera.rows[row][i] <= bounds.y;
        }
    return bounded;
}

glm::vec3 seen(const CameraColour& camera, glm::vec4 foreground) {
    return {glm::dot(camera.rows[0], foreground), glm::dot(camera.rows[1], foreground),
            glm::dot(camera.rows[2], foreground)};
}

glm::dvec3 encoded(glm::vec3 linear) {
    return {media::srgb_from_linear(double{linear.r}), media::srgb_from_linear(double{linear.g}),
            media::srgb_from_linear(double{linear.b})};
}

glm::dvec3 shown(const CameraColour& camera, glm::vec4 foreground, glm::vec4 background) {
    return encoded(glm::max(seen(camera, foreground) + (1 - foreground.a) * glm::vec3(background), 0.0f));
}

CameraColour inverse(const CameraColour& camera) {
    glm::dmat4 affine(1);  // its columns are the rows of the camera
    for (int row = 0; row < 3; ++row) affine[row] = camera.rows[row];
    assert(glm::determinant(affine) != 0 && "a colour that can be inverted");
    const glm::dmat4 inverted = glm::inverse(affine);
    return {{glm::vec4(inverted[0]), glm::vec4(inverted[1]), glm::vec4(inverted[2])}};
}

glm::vec3 gains(const CameraColour& camera) {
    return {camera.rows[0].r, camera.rows[1].g, camera.rows[2].b};
}

float vignette_at(glm::vec2 vignette, float r2) {
    const float inside = std::min(r2, 1.0f);  // the middle of a tile at the edge may lie beyond the corner
    return 1 + vignette.x * inside + vignette.y * inside * inside;
}

CameraColours::CameraColours(size_t cameras, size_t frames, ColourRefinement what)
    : values(what.any() ? cameras : 0, kNeutralColour),
      first(what.colour ? cameras : 0, CameraColour{}),
      second(what.colour ? cameras : 0, CameraColour{}),
      exposures(what.exposure ? cameras * frames : 0),
      vignettes(what.vignetting ? 2 * cameras : 0) {}

void CameraColours::join_exposures() {
    if (first.empty() || frames() == 0) return;
    for (size_t camera = 0; camera < cameras(); ++camera) {
        float sum = 0, count = 0;
        for (size_t i = camera * frames(); i < (camera + 1) * frames(); ++i)
            if (exposures.second[i] > 0) sum += exposures.values[i], count++;
        if (count == 0) continue;
        for (size_t i = camera * frames(); i < (camera + 1) * frames(); ++i)
            if (exposures.second[i] > 0) exposures.values[i] -= sum / count;
        for (glm::vec4& row : values[camera].rows) row *= std::exp(sum / count);
    }
    centre(values);
    keep_in_bounds(values);
}

void CameraColours::keep(ColourRefinement what) {
    CameraColours kept(cameras(), frames(), what);
    if (what.colour) {
        kept.values = values;
        kept.first = first;
        kept.second = second;
    }
    if (what.exposure) kept.exposures = exposures;
    if (what.vignetting) kept.vignettes = vignettes;
    *this = kept;
}

CameraColour CameraColours::of_tile(const Batch& batch, size_t tile, const stage::Camera& camera) const {
    const uint32_t index = batch.tiles[tile].camera;
    float scale = 1;
    if (!exposures.values.empty()) scale *= std::exp(exposures.values[index * frames() + batch.frame]);
    if (!vignettes.values.empty())
        scale *= vignette_at(vignette_of(vignettes, index), radius_squared(batch, tile, camera));
    CameraColour colour = values[index];
    for (glm::vec4& row : colour.rows) row *= scale;
    return colour;
}

void CameraColours::learn(const Batch& batch, const std::vector<stage::Camera>& all_cameras,
                          const CameraColour* tile_gradients, float rate, uint64_t step) {
    if (empty()) return;
    std::vector<CameraColour> by_colour(cameras(), CameraColour{});
    std::vector<float> by_exposure(cameras()), pixels(cameras());
    std::vector<glm::vec2> by_vignette(cameras(), glm::vec2(0));
    for (size_t tile = 0; tile < batch.tiles.size(); ++tile) {
        const uint32_t camera = batch.tiles[tile].camera;
        const float r2 = radius_squared(batch, tile, all_cameras[camera]);
        const float vignette = vignettes.values.empty() ? 1 : vignette_at(vignette_of(vignettes, camera), r2);
        const float exposure =
            exposures.values.empty() ? 1 : std::exp(exposures.values[camera * frames() + batch.frame]);
        float by_scale = 0;  // the tile's colour is scale × the camera's
        for (int row = 0; row < 3; ++row) {
            by_colour[camera].rows[row] += exposure * vignette * tile_gradients[tile].rows[row];
            by_scale += glm::dot(tile_gradients[tile].rows[row], values[camera].rows[row]);
        }
        by_exposure[camera] += by_scale * vignette * exposure;
        by_vignette[camera] += by_scale * exposure * glm::vec2(r2, r2 * r2);
        pixels[camera] += static_cast<float>(kTilePixels / (batch.samples * batch.samples));
    }
    const Adam adam(rate, step);
    for (size_t camera = 0; camera < cameras(); ++camera) {
        const float count = pixels[camera];
        if (count == 0) continue;
        for (int row = 0; row < 3 && !first.empty(); ++row)
            for (int i = 0; i < 4; ++i) {
                float& value = values[camera].rows[row][i];
                const float pull = 2 * count * prior_of(row, i) * (value - kNeutralColour.rows[row][i]);
                adam.move(value, first[camera].rows[row][i], second[camera].rows[row][i],
                          by_colour[camera].rows[row][i] + pull);
            }
        if (!exposures.values.empty())
            adam.move(exposures, camera * frames() + batch.frame, by_exposure[camera], count * kGainPrior);
        for (int i = 0; i < 2 && !vignettes.values.empty(); ++i)
            adam.move(vignettes, 2 * camera + static_cast<size_t>(i), by_vignette[camera][i], count * kVignettePrior);
    }
    if (!first.empty()) centre(values);
    if (frames() > 0) centre(exposures, batch.frame, frames());
    for (const size_t number : {0u, 1u}) centre(vignettes, number, 2);
    keep_in_bounds(values);
    keep_in_bounds(exposures, kMaxExposure);
    keep_in_bounds(vignettes, kMaxVignette);
}

}  // namespace neuvv::training
