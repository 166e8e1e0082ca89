// Training learns the colour of each camera, so that cameras with different gains or white balance agree. Only what
// they do differently can be known: the mean of all cameras' colours is the neutral one.
#pragma once

#include "shared/training.h"
#include "training/batch.h"

namespace neuvv::training {

constexpr CameraColour kNeutralColour{{glm::vec4(1, 0, 0, 0), glm::vec4(0, 1, 0, 0), glm::vec4(0, 0, 1, 0)}};

// The colour of a premultiplied foreground (C, α) as the camera sees it.
glm::vec3 seen(const CameraColour& camera, glm::vec4 foreground);

// Whether the colour lies within the bounds in which learnt colours stay: gains of 1/2 to 2, and the other numbers
// small enough that it can be inverted. NaN does not.
bool is_bounded(const CameraColour& camera);

// The camera that takes back what `camera` did, which must be bounded (assert).
CameraColour inverse(const CameraColour& camera);

// By how much the camera amplifies R, G, B: the diagonal of A.
glm::vec3 gains(const CameraColour& camera);

// The colours by camera with Adam's moments; all empty where colours are not refined.
struct CameraColours {
    CameraColours() = default;
    explicit CameraColours(size_t cameras);  // neutral

    // Moves the colours of the batch's cameras by Adam, from the derivatives by each tile's colour and a prior that
    // pulls towards the neutral colour; then makes the mean of all cameras neutral, and all bounded. `step` counts
    // from 1.
    void learn(const Batch& batch, const CameraColour* tile_gradients, float rate, uint64_t step);

    std::vector<CameraColour> values, first, second;
};

}  // namespace neuvv::training
