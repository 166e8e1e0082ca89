// The trainer's body against the performer's mesh: which limb a place of its skin belongs to, what hides what, and from
// where errors are seen.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "coach/coach.h"
#include "motion/detector.h"
#include "motion/skeleton/humanoid.h"
#include "motion/trainee.h"
#include "reference/highlight.h"
#include "stage/pose.h"
#include "support/body_tree.h"

namespace neuvv::test::body_test {
namespace {

using motion::Limb;

constexpr double kFps = 25;

const stage::GltfScene& performer() {
    static const stage::GltfScene scene = stage::load_gltf(NEUVV_SOURCE_DIR "/tools/performer/performer.glb");
    return scene;
}

const motion::SkeletonClip& dancer() {
    static const motion::SkeletonClip clip = performer_motion(75);
    return clip;
}

// The limb of a bone of the performer's skin, by its name; nothing for bones between two limbs.
std::optional<Limb> limb_of_skin_bone(const std::string& name) {
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    const bool left = has("left") || has("Left") || name.ends_with("_l") || name.ends_with(".L");
    if (has("rm") || has("and")) return left ? Limb::kLeftArm : Limb::kRightArm;
    if (has("eg") || has("oot") || has("oe")) return left ? Limb::kLeftLeg : Limb::kRightLeg;
    if (has("ead")) return Limb::kHead;
    if (has("pine") || has("hest")) return Limb::kTrunk;
    return std::nullopt;
}

struct Skin {
    std::vector<glm::dvec3> positions;
    std::vector<std::optional<Limb>> limbs;  // of each position
    std::vector<uint32_t> triangles;
};

Skin skin_at(double time_s) {
    const stage::GltfScene& scene = performer();
    const stage::PosedScene pose = stage::pose_scene(scene, 0, time_s);
    Skin skin;
    stage::PosedVertices posed;
    for (uint32_t node = 0; node < scene.nodes.size(); ++node) {
        if (scene.nodes[node].mesh < 0) continue;
        for (const stage::GltfPrimitive& primitive :
             scene.meshes[static_cast<size_t>(scene.nodes[node].mesh)].primitives) {
            const auto first = static_cast<uint32_t>(skin.positions.size());
            stage::pose_vertices(scene, pose, node, primitive, posed);
            for (size_t v = 0; v < posed.positions.size(); ++v) {
                skin.positions.emplace_back(posed.positions[v]);
                const glm::vec4 weights = primitive.weights[v];
                int most = 0;
                for (int i = 1; i < 4; ++i)
                    if (weights[i] > weights[most]) most = i;
                const stage::GltfSkin& bones = scene.skins[static_cast<size_t>(scene.nodes[node].skin)];
                const std::string& name = scene.nodes[bones.joints[primitive.joints[v][most]]].name;
                skin.limbs.push_back(weights[most] > 0.6f ? limb_of_skin_bone(name) : std::nullopt);
            }
            for (const uint32_t index : primitive.indices) skin.triangles.push_back(first + index);
        }
    }
    return skin;
}

TEST(Body, ItsSkinBelongsToTheLimbThatMovesIt) {
    size_t right = 0, all = 0;
    std::array<std::array<size_t, motion::kLimbs>, motion::kLimbs> confusion{};
    for (const double time_s : {0.0, 0.7, 1.5, 2.2}) {
        const Skin skin = skin_at(time_s);
        const auto body = coach::body_of(motion::pose_at(dancer(), time_s * kFps), height_of(dancer()));
        std::vector<reference::Capsule> bones;
        for (const coach::BodyBone& each : body) bones.push_back({each.bone.from, each.bone.to, each.bone.radius});
        for (size_t v = 0; v < skin.positions.size(); ++v) {
            if (!skin.limbs[v]) continue;
            const Limb found = body[reference::nearest_bone(bones, skin.positions[v])].limb;
            ++confusion[motion::index_of(*skin.limbs[v])][motion::index_of(found)];
            ++all;
            right += found == *skin.limbs[v];
        }
    }
    std::printf("%zu of %zu vertices belong to the limb that moves them\n", right, all);
    for (size_t a = 0; a < motion::kLimbs; ++a) {
        size_t total = 0;
        for (const size_t count : confusion[a]) total += count;
        EXPECT_GT(total, 50u) << motion::kLimbNames[a];
        EXPECT_GT(static_cast<double>(confusion[a][a]), 0.85 * static_cast<double>(total)) << motion::kLimbNames[a];
    }
    EXPECT_GT(static_cast<double>(right), 0.97 * static_cast<double>(all));
}

// Whether a triangle of the skin lies between an eye and a joint, more than a limb's thickness before the joint.
bool is_hidden_by_skin(const Skin& skin, const glm::dvec3& joint, const glm::dvec3& eye) {
    constexpr double kThickness_m = 0.12;
    const double distance = glm::distance(joint, eye);
    const glm::dvec3 direction = (joint - eye) / distance;
    for (size_t i = 0; i < skin.triangles.size(); i += 3) {
        const glm::dvec3 &a = skin.positions[skin.triangles[i]], &b = skin.positions[skin.triangles[i + 1]],
                         &c = skin.positions[skin.triangles[i + 2]];
        const glm::dvec3 p = glm::cross(direction, c - a);
        const double det = glm::dot(b - a, p);
        if (std::abs(det) < 1e-15) continue;
        const glm::dvec3 s = (eye - a) / det;
        const double u = glm::dot(s, p);
        if (u < 0 || u > 1) continue;
        const glm::dvec3 q = glm::cross(s, b - a);
        const double v = glm::dot(direction, q), t = glm::dot(c - a, q);
        if (v >= 0 && u + v <= 1 && t > 0 && t < distance - kThickness_m) return true;
    }
    return false;
}

// The angle under which an eye sees the errors, where the skin hides them it is 0.
double seen_past_skin(const std::vector<coach::JointError>& errors, const Skin& skin, const glm::dvec3& eye) {
    double sum = 0, weights = 0;
    for (const coach::JointError& error : errors) {
        weights += error.weight;
        if (is_hidden_by_skin(skin, error.to, eye)) continue;
        const double angle = std::acos(
            std::clamp(glm::dot(glm::normalize(error.from - eye), glm::normalize(error.to - eye)), -1.0, 1.0));
        sum += error.weight * angle * angle;
    }
    return std::sqrt(sum / weights);
}

// For errors of a limb at times of the dance: the least share that the chosen eye sees of what any eye sees.
double least_share(Limb limb, double angle_deg) {
    const motion::SkeletonClip trainee = limb == Limb::kLeftArm || limb == Limb::kRightArm
                                             ? with_arm_off(dancer(), limb, angle_deg, 0, 3)
                                             : with_late_leg(dancer(), limb, 0.4, 0, 3);
    coach::LimbValues red{};
    red[motion::index_of(limb)] = 1;
    const double distance = coach::kViewDistance * height_of(dancer());
    double least = 1;
    for (size_t frame = 6; frame < dancer().frames.size(); frame += 12) {
        const motion::Pose& shown = dancer().frames[frame];
        const auto errors = coach::joint_errors(coach::ghost_of(trainee.frames[frame], shown, 0), shown, red);
        if (errors.empty()) continue;
        const glm::dvec3 centre = motion::at(shown, motion::Joint::kPelvis).position;
        const auto body = coach::body_of(shown, height_of(dancer()));
        const Skin skin = skin_at(static_cast<double>(frame) / kFps);
        coach::ViewChooser chooser;
        const auto chosen = chooser.choose(errors, body, centre, distance, 0.02);
        double best = 0;
        for (int height_deg = -15; height_deg <= 60; height_deg += 15)
            for (int turn_deg = 0; turn_deg < 360; turn_deg += 10) {
                const double up = glm::radians(double(height_deg)), turn = glm::radians(double(turn_deg));
                const glm::dvec3 direction(std::cos(up) * std::sin(turn), std::sin(up), std::cos(up) * std::cos(turn));
                best = std::max(best, seen_past_skin(errors, skin, centre + distance * direction));
            }
        const double share = seen_past_skin(errors, skin, chosen.value()) / best;
        EXPECT_GE(share, 0.8) << motion::kLimbNames[motion::index_of(limb)] << ", frame " << frame;
        least = std::min(least, share);
    }
    return least;
}

TEST(Viewpoint, ShowsMostOfWhatCanBeSeenPastThePerformersBody) {
    std::printf("least share of the largest angle: left arm %.2f, right arm %.2f, left leg %.2f, right leg %.2f\n",
                least_share(Limb::kLeftArm, 25), least_share(Limb::kRightArm, 25), least_share(Limb::kLeftLeg, 0),
                least_share(Limb::kRightLeg, 0));
}

TEST(Viewpoint, StaysUntilAnotherEyeIsMuchBetterForAWhile) {
    // A wrist that should be to its left, and then ahead.
    const std::vector<coach::JointError> aside = {{motion::Joint::kLeftWrist, {0, 1, 0}, {0.3, 1, 0}, 1}};
    const std::vector<coach::JointError> ahead = {{motion::Joint::kLeftWrist, {0, 1, 0}, {0, 1, 0.3}, 1}};
    coach::ViewChooser chooser;
    EXPECT_FALSE(chooser.choose({}, {}, {0, 1, 0}, 3, 0.02));
    const glm::dvec3 first = chooser.choose(aside, {}, {0, 1, 0}, 3, 0.02).value();
    EXPECT_GT(std::abs(first.z), 2.5) << "from the front or the back";
    double t = 0;
    while (t < 1 && chooser.choose(ahead, {}, {0, 1, 0}, 3, 0.02) == first) t += 0.02;
    EXPECT_NEAR(t, 0.48, 0.03);
    const glm::dvec3 second = chooser.choose(ahead, {}, {0, 1, 0}, 3, 0.02).value();
    EXPECT_GT(std::abs(second.x), 2.5) << "from a side";
    EXPECT_EQ(chooser.choose({}, {}, {0, 1, 0}, 3, 5), second) << "nothing to see is no reason to move";
}

TEST(Viewpoint, ABoneHidesWhatIsBehindItAndNotWhatIsInIt) {
    const std::vector<coach::BodyBone> trunk = {{{{0, 0, 0}, {0, 2, 0}, 0.2f}, Limb::kTrunk}};
    EXPECT_TRUE(coach::is_hidden({0, 1, -1}, trunk, {0, 1, 3}));
    EXPECT_FALSE(coach::is_hidden({0, 1, 1}, trunk, {0, 1, 3})) << "before it";
    EXPECT_FALSE(coach::is_hidden({0, 1, 0.1}, trunk, {0, 1, 3})) << "in it";
    EXPECT_TRUE(coach::is_hidden({0, 0.1, 0}, trunk, {0, 5, 0.1})) << "in it, seen along it";
    EXPECT_FALSE(coach::is_hidden({0.5, 1, -1}, trunk, {0.5, 1, 3})) << "beside it";
    EXPECT_FALSE(coach::is_hidden({0, 3, -1}, trunk, {0, 3, 3})) << "above it";
}

TEST(BodyTree, ALeafIsThereInTheFramesInWhichTheBodyIs) {
    constexpr uint32_t kFrames = 3;
    const voctree::VOctree tree = body_tree(dancer(), kFrames, 1);
    EXPECT_EQ(voctree::defect_of(tree), "");
    size_t left = 0;  // places that the body leaves from one frame to the next
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const auto body_at = [](uint32_t i) {
            return coach::body_of(motion::pose_at(dancer(), i * kFps), height_of(dancer()));
        };
        const auto is_there = [&](const glm::dvec3& point) {
            const uint32_t leaf =
                voctree::find_leaf(tree, (point - glm::dvec3(tree.box_min)) / double{tree.box_size.x});
            return leaf != UINT32_MAX && tree.leaf(leaf)[frame] > 0;
        };
        const std::vector<coach::BodyBone> now = body_at(frame);
        for (const coach::BodyBone& each : now) EXPECT_TRUE(is_there(0.5f * (each.bone.from + each.bone.to))) << frame;
        const double edge = double{tree.box_size.x} / kBodyCells;
        for (const coach::BodyBone& other : body_at((frame + 1) % kFrames)) {
            const glm::dvec3 point(other.bone.to);
            const bool far = std::ranges::none_of(now, [&](const coach::BodyBone& each) {
                return reference::distance_to({each.bone.from, each.bone.to, each.bone.radius}, point) < edge;
            });
            if (!far) continue;
            ++left;
            EXPECT_FALSE(is_there(point)) << frame;
        }
    }
    EXPECT_GT(left, 5u);
}

}  // namespace
}  // namespace neuvv::test::body_test
