// Which performers rays meet on a stage that is being shown, such as the pointer rays of hands.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/box.h"
#include "render/stage_renderer.h"

namespace neuvv::render {

// A ray meets a performer where the performer's alpha along it reaches this share of its opacity.
constexpr float kPointedAlpha = 0.5f;

struct PickedPerformer {
    uint32_t performer = 0;  // index into Stage::performers
    double distance_m = 0;   // along the ray, in the world
    glm::vec3 colour{0};     // of the surface, with paint, without the stage's lights; linear
};

// For each ray (world), the visible performer whose surface it meets first; nothing where it meets none. Surfaces are
// those that the last images have left on the device (FrameRenderer::pick), where the performers are now. It waits for
// the device once for each performer whose leaves' box a ray meets, and builds nothing.
std::vector<std::optional<PickedPerformer>> pick_performers(StageRenderer& renderer,
                                                            const stage::EvaluatedStage& evaluated,
                                                            std::span<const Ray> rays);

}  // namespace neuvv::render
