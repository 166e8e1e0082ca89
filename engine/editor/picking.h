// What a pixel of the image shows.
#pragma once

#include <optional>

#include "editor/render_thread.h"

namespace neuvv::editor {

struct PickedPoint {
    std::optional<uint32_t> node;  // of a performer or of a piece of the set
    std::optional<glm::dvec3> at;  // world: where
};

// Of the performers whose boxes the ray meets, the nearest whose alpha there is at least a half, the set before it
// counted; else the set's nearest triangle. `pixel` as cameras count. A task of the render thread: it draws one pixel
// for each of those boxes.
PickedPoint pick_at(OnDevice& on_device, const stage::EvaluatedStage& evaluated, const stage::Camera& camera,
                    glm::dvec2 pixel);

}  // namespace neuvv::editor
