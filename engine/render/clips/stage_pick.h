// Which performers rays meet on a stage that is being shown, such as the pointer rays of hands.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/box.h"
#include "render/clips/stage_renderer.h"

namespace neuvv::render {

// A ray meets a performer where the performer's alpha along it reaches this share of its opacity.
constexpr float kPointedAlpha = 0.5f;

struct PickedPerformer {
    uint32_t performer = 0;  // index into Stage::performers
    double distance_m = 0;   // along the ray, in the world
    glm::vec3 colour{0};     // of the surface, with paint, without the stage's lights; linear
};

// For each ray (world), the visible performer whose surface it meets first; nothing where it meets none. Surfaces are
// those that the last images have left on the device (FrameRenderer::begin_pick), where the performers are now. It
// builds nothing. A renderer can have one at a time between begin() and take() (assert).
class PerformerPicks {
  public:
    // Has the device pick after the images that are under way, with at most 64 rays (assert). The stage that the
    // renderer shows must not become another one before take().
    void begin(StageRenderer& renderer, const stage::EvaluatedStage& evaluated, std::span<const Ray> rays);
    // The results for the rays of the last begin(), or none where they were taken already. It waits for them, but for
    // no image that was submitted since then.
    std::vector<std::optional<PickedPerformer>> take(StageRenderer& renderer);

  private:
    struct Begun {
        uint32_t performer = 0;
        std::vector<size_t> rays;             // those that meet its box
        std::vector<double> world_per_local;  // by such a ray: metres of the world a metre along it
    };
    std::vector<Begun> begun_;
    size_t rays_ = 0;
};

// Both in one call, which waits for the device.
std::vector<std::optional<PickedPerformer>> pick_performers(StageRenderer& renderer,
                                                            const stage::EvaluatedStage& evaluated,
                                                            std::span<const Ray> rays);

}  // namespace neuvv::render
