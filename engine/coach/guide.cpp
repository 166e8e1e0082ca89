#include "coach/guide.h"

#include <cmath>

namespace neuvv::coach {

namespace {

constexpr double kHeadLength = 0.25, kHeadWidth = 0.12;  // of an arrow's length

void add_ghost(const motion::Pose& ghost, const LimbValues& red, std::vector<GuideLine>& lines) {
    for (size_t j = 1; j < motion::kJoints; ++j) {
        const motion::JointInfo& info = motion::info_of(motion::joint_at(j));
        const motion::JointSample& parent = motion::at(ghost, info.parent);
        if (!(ghost[j].confidence > 0) || !(parent.confidence > 0)) continue;
        const bool wrong = red[motion::index_of(info.limb)] > 0.5;
        lines.push_back({parent.position, ghost[j].position, wrong ? GuideKind::kGhostWrong : GuideKind::kGhost});
    }
}

// A shaft, and two lines of a head that is level where the arrow is not vertical.
void add_arrow(const JointError& error, std::vector<GuideLine>& lines) {
    const glm::dvec3 along = error.to - error.from, unit = glm::normalize(along);
    const glm::dvec3 up = std::abs(unit.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
    const glm::dvec3 side = glm::normalize(glm::cross(up, unit)) * (kHeadWidth * glm::length(along));
    const glm::dvec3 base = error.to - kHeadLength * along;
    lines.push_back({error.from, error.to, GuideKind::kArrow});
    lines.push_back({base + side, error.to, GuideKind::kArrow});
    lines.push_back({base - side, error.to, GuideKind::kArrow});
}

}  // namespace

std::vector<GuideLine> guide_of(const Coach& coach) {
    std::vector<GuideLine> lines;
    const std::optional<motion::Pose> ghost = coach.ghost();
    if (!ghost) return lines;
    if (coach.settings().ghost) add_ghost(*ghost, coach.red(), lines);
    if (coach.settings().arrows)
        for (const JointError& error : coach.errors()) add_arrow(error, lines);
    return lines;
}

}  // namespace neuvv::coach
