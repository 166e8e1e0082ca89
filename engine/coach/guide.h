// The ghost and the arrows as lines, which windows, headsets and videos draw over the stage.
#pragma once

#include <vector>

#include "coach/coach.h"

namespace neuvv::coach {

enum class GuideKind {
    kGhost,       // a bone of the trainee
    kGhostWrong,  // one of a red limb
    kArrow,       // from a joint of the trainee to where it should be
};

struct GuideLine {
    glm::dvec3 from{0}, to{0};  // the performer's space, metres
    GuideKind kind = GuideKind::kGhost;
};

// Colours of the kinds, sRGB, 0..1.
constexpr glm::vec3 kGuideColours[] = {{0.55f, 0.85f, 1.0f}, {1.0f, 0.45f, 0.35f}, {1.0f, 0.9f, 0.2f}};

// What the settings of the coach let be seen; empty where nobody is compared.
std::vector<GuideLine> guide_of(const Coach& coach);

}  // namespace neuvv::coach
