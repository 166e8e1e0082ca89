#include "motion/skeleton/humanoid.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "motion/skeleton/bone_names.h"

namespace neuvv::motion {

namespace {

FoundBones bones_of(std::span<const RestBone> rest, const std::string& file) {
    std::vector<std::string> names;
    for (const RestBone& bone : rest) names.push_back(bone.name);
    const FoundBones found = find_bones(names);
    if (const std::string missing = found.missing(); !missing.empty())
        throw InputError(file, "", "has no bones of these names: " + missing,
                         "name them as VRM does (hips, head, leftUpperArm, leftLowerArm, leftHand, leftUpperLeg, "
                         "leftLowerLeg, leftFoot)");
    return found;
}

// The directions of a body at rest, and a length to measure the rest by.
struct BodyFrame {
    glm::dvec3 left, up, forward;
    double leg = 0;  // thigh and shin, metres
};

class Finder {
  public:
    Finder(std::span<const RestBone> rest, const std::string& file) : rest_(rest), found_(bones_of(rest, file)) {
        const glm::dvec3 hips = 0.5 * (origin(kThigh, Side::kLeft) + origin(kThigh, Side::kRight));
        const glm::dvec3 shoulders = 0.5 * (origin(kUpperArm, Side::kLeft) + origin(kUpperArm, Side::kRight));
        const glm::dvec3 across = origin(kThigh, Side::kLeft) - origin(kThigh, Side::kRight);
        frame_.leg = glm::distance(origin(kThigh, Side::kLeft), origin(kShin, Side::kLeft)) +
                     glm::distance(origin(kShin, Side::kLeft), origin(kFoot, Side::kLeft));
        const glm::dvec3 forward = glm::cross(across, shoulders - hips);
        if (!(glm::length(forward) > 1e-6 * frame_.leg * frame_.leg && frame_.leg > 0))
            throw InputError(file, "", "has a rest pose without a body: hips, shoulders and legs lie on one line",
                             "export the skeleton with its rest pose");
        frame_.up = glm::normalize(shoulders - hips);
        frame_.forward = glm::normalize(forward);
        frame_.left = glm::cross(frame_.up, frame_.forward);
    }

    JointSources sources() const {
        JointSources all;
        const auto set = [&](Joint joint, std::vector<JointSource::Point> points, bool measured) {
            all[index_of(joint)] = {std::move(points), measured};
        };
        set(Joint::kPelvis, {bone_point(kThigh, Side::kRight), bone_point(kThigh, Side::kLeft)}, true);
        set(Joint::kNeck, {bone_point(kUpperArm, Side::kRight), bone_point(kUpperArm, Side::kLeft)}, true);
        const auto skin = found_.has(kHeadBone) ? extreme(kHeadBone, Side::kNone, frame_.forward) : std::nullopt;
        const auto nose = first_of(skin, kNoseBone, Side::kNone);
        set(Joint::kNose, {nose ? *nose : beside(kHeadBone, Side::kNone, 0, 0.08, 0.13)}, nose.has_value());
        for (const Side side : {Side::kRight, Side::kLeft}) add_side(all, side);
        return all;
    }

  private:
    void add_side(JointSources& all, Side side) const {
        const auto set = [&](Joint right, JointSource::Point point, bool measured) {
            const Joint joint = side == Side::kRight ? right : info_of(right).mirrored;
            all[index_of(joint)] = {{point}, measured};
        };
        set(Joint::kRightShoulder, bone_point(kUpperArm, side), true);
        set(Joint::kRightElbow, bone_point(kForearm, side), true);
        set(Joint::kRightWrist, bone_point(kHand, side), true);
        set(Joint::kRightHip, bone_point(kThigh, side), true);
        set(Joint::kRightKnee, bone_point(kShin, side), true);
        set(Joint::kRightAnkle, bone_point(kFoot, side), true);
        const glm::dvec3 out = side == Side::kLeft ? frame_.left : -frame_.left, down = -frame_.up;
        const glm::dvec3 forward = frame_.forward;
        // Toes have bones of their own in some skeletons; their skin is then not the foot's.
        const BoneKind front = found_.has(kToes, side) && !rest_[found_.of(kToes, side)].skin.empty() ? kToes : kFoot;
        const auto heel = first_of(extreme(kFoot, side, down - 2.0 * forward), kHeel, side);
        set(Joint::kRightHeel, heel ? *heel : beside(kFoot, side, 0, -0.09, -0.06), heel.has_value());
        const auto big = first_of(extreme(front, side, 2.0 * forward + 0.5 * down - out), kBigToe, side);
        set(Joint::kRightBigToe, big ? *big : beside(kFoot, side, -0.02, -0.09, 0.19), big.has_value());
        const auto small = first_of(extreme(front, side, forward + 0.5 * down + 2.0 * out), kSmallToe, side);
        set(Joint::kRightSmallToe, small ? *small : beside(kFoot, side, 0.06, -0.09, 0.14), small.has_value());
    }

    glm::dvec3 origin(BoneKind kind, Side side) const { return rest_[found_.of(kind, side)].world_from_bone[3]; }

    JointSource::Point bone_point(BoneKind kind, Side side) const { return {found_.of(kind, side), glm::dvec3(0)}; }

    // A point of the skin; else the bone that lies there, where the skeleton has one.
    std::optional<JointSource::Point> first_of(std::optional<JointSource::Point> skin, BoneKind kind, Side side) const {
        return skin || !found_.has(kind, side) ? skin : bone_point(kind, side);
    }

    // A point of the world at rest, fixed to a bone.
    JointSource::Point fixed(size_t bone, glm::dvec3 world) const {
        return {bone, glm::inverse(rest_[bone].world_from_bone) * glm::dvec4(world, 1)};
    }

    // By a body's proportions: outwards, up and forwards of a bone, in lengths of a leg.
    JointSource::Point beside(BoneKind kind, Side side, double out, double up, double forward) const {
        const size_t bone = found_.of(kind, side);
        const glm::dvec3 outward = side == Side::kLeft ? frame_.left : -frame_.left;
        return fixed(bone, glm::dvec3(rest_[bone].world_from_bone[3]) +
                               frame_.leg * (out * outward + up * frame_.up + forward * frame_.forward));
    }

    // The skin's vertex that lies farthest in a direction.
    std::optional<JointSource::Point> extreme(BoneKind kind, Side side, glm::dvec3 direction) const {
        const size_t bone = found_.of(kind, side);
        const std::vector<glm::dvec3>& skin = rest_[bone].skin;
        if (skin.empty()) return std::nullopt;
        const auto along = [&](const glm::dvec3& p) { return glm::dot(p, direction); };
        return fixed(bone, *std::ranges::max_element(skin, {}, along));
    }

    std::span<const RestBone> rest_;
    FoundBones found_;
    BodyFrame frame_;
};

}  // namespace

JointSources joint_sources(std::span<const RestBone> bones, const std::string& file) {
    return Finder(bones, file).sources();
}

Pose pose_of(const JointSources& sources, std::span<const glm::dmat4> world_from_bones) {
    Pose pose;
    for (size_t j = 0; j < kJoints; ++j) {
        const JointSource& source = sources[j];
        if (source.points.empty()) continue;
        for (const JointSource::Point& point : source.points)
            pose[j].position += glm::dvec3(world_from_bones[point.bone] * glm::dvec4(point.offset, 1)) /
                                static_cast<double>(source.points.size());
        pose[j].confidence = 1;
        pose[j].measured = source.measured;
    }
    return pose;
}

}  // namespace neuvv::motion
