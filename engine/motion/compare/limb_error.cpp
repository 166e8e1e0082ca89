#include "motion/compare/limb_error.h"

#include <algorithm>
#include <cmath>

namespace neuvv::motion {

namespace {

enum class Frame : uint8_t { kWorld, kShoulders, kHips };

struct ComparedBone {
    Joint from, to;
    Limb limb;
    Frame frame;
    double weight;
};

constexpr std::array<ComparedBone, kComparedBones> kCompared = [] {
    using enum Joint;
    using enum Limb;
    return std::array<ComparedBone, kComparedBones>{{
        {kPelvis, kNeck, kTrunk, Frame::kWorld, 1},
        {kRightHip, kLeftHip, kTrunk, Frame::kWorld, 1},
        {kRightShoulder, kLeftShoulder, kTrunk, Frame::kWorld, 1},
        {kNeck, kNose, kHead, Frame::kShoulders, 1},
        {kRightShoulder, kRightElbow, kRightArm, Frame::kShoulders, 1},
        {kRightElbow, kRightWrist, kRightArm, Frame::kShoulders, 1},
        {kLeftShoulder, kLeftElbow, kLeftArm, Frame::kShoulders, 1},
        {kLeftElbow, kLeftWrist, kLeftArm, Frame::kShoulders, 1},
        {kRightHip, kRightKnee, kRightLeg, Frame::kHips, 1},
        {kRightKnee, kRightAnkle, kRightLeg, Frame::kHips, 1},
        {kRightAnkle, kRightBigToe, kRightLeg, Frame::kHips, 0.3},
        {kLeftHip, kLeftKnee, kLeftLeg, Frame::kHips, 1},
        {kLeftKnee, kLeftAnkle, kLeftLeg, Frame::kHips, 1},
        {kLeftAnkle, kLeftBigToe, kLeftLeg, Frame::kHips, 0.3},
    }};
}();
constexpr size_t kTrunkBones = 3;  // the first ones
constexpr double kUsual = 0.034;   // 1 − cos 15°

// How sure both ends of a bone are; 0 where one is not measured.
double certainty(const Pose& pose, Joint from, Joint to) {
    const JointSample &a = at(pose, from), &b = at(pose, to);
    return a.measured && b.measured ? std::min(a.confidence, b.confidence) : 0;
}

// Axes of the part of the body around a line across it: left, up along the trunk, forward.
struct BodyAxes {
    glm::dmat3 axes{1};
    double weight = 0;
};

BodyAxes axes_around(const Pose& pose, Joint right, Joint left) {
    const glm::dvec3 across = at(pose, left).position - at(pose, right).position;
    const glm::dvec3 up = at(pose, Joint::kNeck).position - at(pose, Joint::kPelvis).position;
    const glm::dvec3 forward = glm::cross(across, up);
    const double weight = std::min(certainty(pose, right, left), certainty(pose, Joint::kPelvis, Joint::kNeck));
    if (!(glm::length(forward) > 1e-6)) return {};
    const glm::dvec3 x = glm::normalize(across), z = glm::normalize(forward);
    return {glm::dmat3(x, glm::cross(z, x), z), weight};
}

double angle_deg(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::degrees(std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)));
}

}  // namespace

Limb limb_of_bone(size_t compared_bone) {
    return kCompared[compared_bone].limb;
}

Directions directions_of(const Pose& pose) {
    const BodyAxes shoulders = axes_around(pose, Joint::kRightShoulder, Joint::kLeftShoulder);
    const BodyAxes hips = axes_around(pose, Joint::kRightHip, Joint::kLeftHip);
    Directions directions;
    for (size_t b = 0; b < kComparedBones; ++b) {
        const ComparedBone& bone = kCompared[b];
        const glm::dvec3 along = at(pose, bone.to).position - at(pose, bone.from).position;
        const double length = glm::length(along);
        if (!(length > 1e-6)) continue;
        const double sure = certainty(pose, bone.from, bone.to);
        if (bone.frame == Frame::kWorld) {
            directions[b] = {along / length, bone.weight * sure};
        } else {
            const BodyAxes& frame = bone.frame == Frame::kHips ? hips : shoulders;
            directions[b] = {glm::transpose(frame.axes) * along / length, bone.weight * std::min(sure, frame.weight)};
        }
    }
    return directions;
}

glm::dvec3 turned(const glm::dvec3& direction, double yaw) {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return {c * direction.x + s * direction.z, direction.y, -s * direction.x + c * direction.z};
}

Directions turned(const Directions& directions, double yaw) {
    Directions result = directions;
    for (size_t b = 0; b < kTrunkBones; ++b) result[b].direction = turned(directions[b].direction, yaw);
    return result;
}

LimbErrors limb_errors(const Directions& a, const Directions& b) {
    LimbErrors squares{}, weights{};
    for (size_t i = 0; i < kComparedBones; ++i) {
        const double weight = std::min(a[i].weight, b[i].weight), angle = angle_deg(a[i].direction, b[i].direction);
        squares[index_of(kCompared[i].limb)] += weight * angle * angle;
        weights[index_of(kCompared[i].limb)] += weight;
    }
    for (size_t limb = 0; limb < kLimbs; ++limb)
        squares[limb] = weights[limb] > 0 ? std::sqrt(squares[limb] / weights[limb]) : -1;
    return squares;
}

double distance(const Directions& a, const Directions& b, bool without_trunk) {
    double sum = 0, weights = 0;
    for (size_t i = without_trunk ? kTrunkBones : 0; i < kComparedBones; ++i) {
        const double weight = std::min(a[i].weight, b[i].weight);
        const double apart = 1 - glm::dot(a[i].direction, b[i].direction);
        sum += weight * apart / (1 + apart / kUsual);
        weights += weight;
    }
    return weights > 0 ? sum / weights : 1;
}

double yaw_between(const Directions& from, const Directions& to) {
    double sine = 0, cosine = 0;
    for (const size_t i : {kHipLine, kShoulderLine}) {
        const double weight = std::min(from[i].weight, to[i].weight);
        const glm::dvec3 &a = from[i].direction, &b = to[i].direction;
        cosine += weight * (a.x * b.x + a.z * b.z);
        sine += weight * (a.z * b.x - a.x * b.z);
    }
    return sine == 0 && cosine == 0 ? NAN : std::atan2(sine, cosine);
}

double limb_score(Limb limb, double error_deg, const Tolerances& tolerances) {
    if (error_deg < 0) return -1;
    const double beyond = std::max(0.0, error_deg - tolerances.tolerance[index_of(limb)]) / tolerances.scale;
    return std::exp(-beyond * beyond);
}

}  // namespace neuvv::motion
