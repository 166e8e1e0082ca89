#include "coach/ghost.h"

#include "motion/compare/limb_error.h"

namespace neuvv::coach {

namespace {

constexpr double kAlike_m = 0.03;

bool is_known(const motion::JointSample& sample) {
    return sample.confidence > 0;
}

// The joint by which the trainee is put on the trainer: the first that both know.
const motion::JointSample* anchor_of(const motion::Pose& trainee, const motion::Pose& trainer, glm::dvec3& place) {
    for (size_t j = 0; j < motion::kJoints; ++j)
        if (is_known(trainee[j]) && is_known(trainer[j])) {
            place = trainer[j].position;
            return &trainee[j];
        }
    return nullptr;
}

}  // namespace

motion::Pose ghost_of(const motion::Pose& trainee, const motion::Pose& trainer, double yaw) {
    motion::Pose ghost;
    glm::dvec3 place(0);
    const motion::JointSample* anchor = anchor_of(trainee, trainer, place);
    if (!anchor) return ghost;
    for (size_t j = 0; j < motion::kJoints; ++j) {
        if (!is_known(trainee[j]) || !is_known(trainer[j])) continue;
        ghost[j] = trainee[j];
        ghost[j].position = place + motion::turned(trainee[j].position - anchor->position, -yaw);
        const size_t parent = motion::index_of(motion::info_of(motion::joint_at(j)).parent);
        const glm::dvec3 bone = motion::turned(trainee[j].position - trainee[parent].position, -yaw);
        if (parent == j || !is_known(ghost[parent]) || !(glm::length(bone) > 1e-6)) continue;
        const double length = glm::distance(trainer[j].position, trainer[parent].position);
        ghost[j].position = ghost[parent].position + length * glm::normalize(bone);
    }
    return ghost;
}

std::vector<JointError> joint_errors(const motion::Pose& ghost, const motion::Pose& trainer, const LimbValues& red) {
    std::vector<JointError> errors;
    for (size_t j = 0; j < motion::kJoints; ++j) {
        const double weight = red[motion::index_of(motion::info_of(motion::joint_at(j)).limb)];
        if (!(weight > 0) || !ghost[j].measured || !trainer[j].measured) continue;
        if (glm::distance(ghost[j].position, trainer[j].position) < kAlike_m) continue;
        errors.push_back({motion::joint_at(j), ghost[j].position, trainer[j].position, weight});
    }
    return errors;
}

}  // namespace neuvv::coach
