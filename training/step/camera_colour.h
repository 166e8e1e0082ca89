// Training learns how cameras show colours, so that images agree: the colour of each camera (gains and white balance),
// the exposure of each image, and how much a lens darkens towards the corners. Only what cameras do differently can be
// known: the mean over all cameras is neutral. (Where all lenses darken alike and all cameras look at the performer, a
// darker performer at the images' edges explains as much.)
#pragma once

#include "shared/training.h"
#include "training/step/batch.h"

namespace neuvv::training {

constexpr CameraColour kNeutralColour{{glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)}};

// The colour of a premultiplied foreground (C, α) as the camera sees it.
glm::vec3 seen(const CameraColour& camera, glm::vec4 foreground);

// sRGB of linear light.
glm::dvec3 encoded(glm::vec3 linear);

// What a camera shows of a ray's foreground in front of a background that it does not change: encoded, 0..1.
glm::dvec3 shown(const CameraColour& camera, glm::vec4 foreground, glm::vec4 background);

// What of it is learnt (`--refine colour,exposure,vignetting`).
struct ColourRefinement {
    bool colour = false, exposure = false, vignetting = false;
    bool any() const { return colour || exposure || vignetting; }
};

// Whether the colour lies within the bounds in which learnt colours stay: gains of 1/2 to 2, and the other numbers
// small enough that it can be inverted. NaN does not.
bool is_bounded(const CameraColour& camera);

// The camera that takes back what `camera` did, which must have an inverse, as bounded ones have.
CameraColour inverse(const CameraColour& camera);

// By how much the camera amplifies R, G, B: the diagonal of A.
glm::vec3 gains(const CameraColour& camera);

// The factor on light at a distance from the principal point; r² is 1 at the distance of the farthest corner.
float vignette_at(glm::vec2 vignette, float r2);

// Single numbers with Adam's moments.
struct LearntNumbers {
    explicit LearntNumbers(size_t count = 0) : values(count), first(count), second(count) {}
    std::vector<float> values, first, second;
};

constexpr float kMaxExposure = 0.7f;  // of the logarithm: factors of 1/2 to 2
constexpr float kMaxVignette = 0.4f;  // of both numbers: a fifth of the light is left at least

// What is learnt, with Adam's moments; all empty where nothing is.
struct CameraColours {
    CameraColours() = default;
    CameraColours(size_t cameras, size_t frames, ColourRefinement what);  // neutral

    bool empty() const { return values.empty(); }
    size_t cameras() const { return values.size(); }
    size_t frames() const { return values.empty() ? 0 : exposures.values.size() / values.size(); }

    // How a tile of the batch shows colours: its image's exposure × its place's vignette × its camera's colour.
    // `camera` is the tile's.
    CameraColour of_tile(const Batch& batch, size_t tile, const stage::Camera& camera) const;

    // Moves what is learnt by Adam, from the derivatives by each tile's colour (of_tile) and a prior that pulls towards
    // neutral; then makes the mean of all cameras neutral, and all bounded. `step` counts from 1.
    void learn(const Batch& batch, const std::vector<stage::Camera>& all_cameras, const CameraColour* tile_gradients,
               float rate, uint64_t step);

    // What all exposures of a camera have in common becomes part of its colour, where both are learnt: images do not
    // tell the one from the other.
    void join_exposures();

    // What is not in `what` becomes neutral, and is not learnt any more.
    void keep(ColourRefinement what);

    std::vector<CameraColour> values;         // by camera
    std::vector<CameraColour> first, second;  // empty where colours are not learnt
    LearntNumbers exposures;                  // logarithms, by camera and then frame; empty where not learnt
    LearntNumbers vignettes;                  // two by camera, the factors of r² and r⁴; empty where not learnt
};

}  // namespace neuvv::training
