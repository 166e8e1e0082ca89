#include "reference/motion.h"

#include <cmath>

namespace neuvv::reference {

namespace {

using motion::Joint;
using motion::Limb;
using motion::Pose;

struct Vector {
    double x, y, z;
};

Vector between(const Pose& pose, Joint from, Joint to) {
    const glm::dvec3 d = motion::at(pose, to).position - motion::at(pose, from).position;
    return {d.x, d.y, d.z};
}
double dot(const Vector& a, const Vector& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector unit(const Vector& a) {
    const double length = std::sqrt(dot(a, a));
    return {a.x / length, a.y / length, a.z / length};
}

// A bone's direction by its coordinates in the frame of the line from right to left; in the world where that is none.
struct Bone {
    Joint from, to, right, left;
    double weight;
};

std::vector<Bone> bones_of(Limb limb) {
    using enum Joint;
    const auto none = kPelvis;
    switch (limb) {
        case Limb::kTrunk:
            return {{kPelvis, kNeck, none, none, 1},
                    {kRightHip, kLeftHip, none, none, 1},
                    {kRightShoulder, kLeftShoulder, none, none, 1}};
        case Limb::kHead:
            return {{kNeck, kNose, kRightShoulder, kLeftShoulder, 1}};
        case Limb::kRightArm:
            return {{kRightShoulder, kRightElbow, kRightShoulder, kLeftShoulder, 1},
                    {kRightElbow, kRightWrist, kRightShoulder, kLeftShoulder, 1}};
        case Limb::kLeftArm:
            return {{kLeftShoulder, kLeftElbow, kRightShoulder, kLeftShoulder, 1},
                    {kLeftElbow, kLeftWrist, kRightShoulder, kLeftShoulder, 1}};
        case Limb::kRightLeg:
            return {{kRightHip, kRightKnee, kRightHip, kLeftHip, 1},
                    {kRightKnee, kRightAnkle, kRightHip, kLeftHip, 1},
                    {kRightAnkle, kRightBigToe, kRightHip, kLeftHip, 0.3}};
        default:
            return {{kLeftHip, kLeftKnee, kRightHip, kLeftHip, 1},
                    {kLeftKnee, kLeftAnkle, kRightHip, kLeftHip, 1},
                    {kLeftAnkle, kLeftBigToe, kRightHip, kLeftHip, 0.3}};
    }
}

Vector direction(const Pose& pose, const Bone& bone) {
    const Vector d = unit(between(pose, bone.from, bone.to));
    if (bone.right == bone.left) return d;
    const Vector x = unit(between(pose, bone.right, bone.left));
    const Vector z = unit(cross(x, between(pose, Joint::kPelvis, Joint::kNeck)));
    return {dot(d, x), dot(d, cross(z, x)), dot(d, z)};
}

double certainty(const Pose& pose, const Bone& bone) {
    double least = 1;
    std::vector<Joint> joints = {bone.from, bone.to};
    if (bone.right != bone.left) joints.insert(joints.end(), {bone.right, bone.left, Joint::kPelvis, Joint::kNeck});
    for (const Joint joint : joints) {
        const motion::JointSample& sample = motion::at(pose, joint);
        least = std::fmin(least, sample.measured ? sample.confidence : 0);
    }
    return least;
}

}  // namespace

double limb_error(const Pose& a, const Pose& b, Limb limb) {
    double squares = 0, weights = 0;
    for (const Bone& bone : bones_of(limb)) {
        const double weight = bone.weight * std::fmin(certainty(a, bone), certainty(b, bone));
        if (weight == 0) continue;
        const double cosine = std::fmax(-1, std::fmin(1, dot(direction(a, bone), direction(b, bone))));
        const double degrees = std::acos(cosine) * 180 / std::acos(-1.0);
        squares += weight * degrees * degrees;
        weights += weight;
    }
    return weights > 0 ? std::sqrt(squares / weights) : -1;
}

double least_cost(const std::vector<std::vector<double>>& distances, double step) {
    std::vector<std::vector<double>> cost = distances;
    for (size_t i = 0; i < cost.size(); ++i)
        for (size_t j = 0; j < cost[i].size(); ++j) {
            double before = i == 0 && j == 0 ? 0 : INFINITY;
            if (i > 0 && j > 0) before = std::fmin(before, cost[i - 1][j - 1]);
            if (i > 0) before = std::fmin(before, cost[i - 1][j] + step);
            if (j > 0) before = std::fmin(before, cost[i][j - 1] + step);
            cost[i][j] += before;
        }
    return cost.back().back();
}

}  // namespace neuvv::reference
