// What a pixel of the image shows.
#pragma once

#include <optional>

#include "editor/draw/render_thread.h"

namespace neuvv::editor {

struct PickedPoint {
    std::optional<uint32_t> node;  // of a performer or of a mesh of the set; nullopt: the pixel shows neither
    std::optional<glm::dvec3> at;  // the point, in the world
};

// Picks the nearest performer whose box the ray meets and whose alpha at the pixel, with the set drawn in front of it,
// is at least half of its opacity; where there is none, the nearest triangle of the set. Pixels count as in cameras,
// with centres at +0.5. To be called in a task of the render thread: it draws one pixel for each of those boxes.
PickedPoint pick_at(OnDevice& on_device, const stage::EvaluatedStage& evaluated, const stage::Camera& camera,
                    glm::dvec2 pixel);

}  // namespace neuvv::editor
