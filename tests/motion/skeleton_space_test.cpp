// Which axis of another program's motion is up, and what its lengths mean.
#include "motion/skeleton/skeleton_space.h"

#include <gtest/gtest.h>

#include "motion/detector.h"
#include "motion/skeleton/skeleton_file.h"
#include "motion/trainee.h"
#include "support/near.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

using motion::Axis;

const motion::SkeletonClip& standing_dancer() {
    static const motion::SkeletonClip clip = test::performer_motion(30);
    return clip;
}

// The dancer in a space whose axes are these of ours.
motion::SkeletonClip in_space(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z, double units = 1) {
    motion::SkeletonClip clip = standing_dancer();
    for (motion::Pose& pose : clip.frames)
        for (motion::JointSample& sample : pose) {
            const glm::dvec3 p = units * sample.position;
            sample.position = {glm::dot(x, p), glm::dot(y, p), glm::dot(z, p)};
        }
    return clip;
}

void expect_dancer(const motion::SkeletonClip& clip, double scale = 1) {
    for (size_t f = 0; f < clip.frames.size(); ++f)
        for (size_t j = 0; j < motion::kJoints; ++j)
            test::expect_near(clip.frames[f][j].position, scale * standing_dancer().frames[f][j].position, 1e-9);
}

const glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

TEST(SkeletonSpace, ABodyIsStoodUp) {
    struct Space {
        Axis up;
        glm::dvec3 x, y, z;
        bool found;  // without the user's word
    };
    const Space spaces[] = {{Axis::kY, kX, kY, kZ, true},        {Axis::kZ, kX, -kZ, kY, true},
                            {Axis::kMinusY, kX, -kY, -kZ, true}, {Axis::kX, kY, -kX, kZ, false},
                            {Axis::kMinusX, -kY, kX, kZ, false}, {Axis::kMinusZ, kX, kZ, -kY, false}};
    for (const Space& space : spaces) {
        SCOPED_TRACE(motion::kAxisNames[static_cast<size_t>(space.up)]);
        const motion::SkeletonClip given = in_space(space.x, space.y, space.z);
        EXPECT_EQ(motion::standing_axis(given), space.up);
        motion::SkeletonClip told = given, guessed = given, gltf = given;
        motion::bring_to_metres({.up = space.up, .unit_m = 1}, "a", told);
        expect_dancer(told);
        EXPECT_TRUE(told.notes.empty());
        motion::bring_to_metres({.unit_m = 1}, "a.bvh", guessed);
        EXPECT_EQ(guessed.notes.size(), space.up == Axis::kY ? 0u : 1u);
        if (space.found) expect_dancer(guessed);
        if (!space.found) {
            EXPECT_NE(guessed.notes.at(0).text.find("a.bvh: the body lies along"), std::string::npos);
            EXPECT_EQ(guessed.notes.at(0).fix.remedy, Remedy::kUpIfTrue);
        }
        motion::bring_to_metres({.y_is_up = true, .unit_m = 1}, "a.glb", gltf);
        EXPECT_EQ(gltf.frames[3][4].position, given.frames[3][4].position) << "glTF says what is up";
        EXPECT_EQ(gltf.notes.size(), space.up == Axis::kY ? 0u : 1u);
    }
}

// Who stands for a while and then lies is not turned, whichever way the head lies.
TEST(SkeletonSpace, WhoLiesDownIsLeftLying) {
    motion::SkeletonClip clip = in_space(kX, -kZ, kY);
    for (size_t f = 0; f < 8; ++f) clip.frames[f] = standing_dancer().frames[f];
    EXPECT_EQ(motion::standing_axis(clip), Axis::kY);
}

TEST(SkeletonSpace, UnitsAreTheLikeliest) {
    constexpr double kInch = 0.0254;
    // Heights of babies who stand, children, adults and giants, in each unit.
    for (const double height_m : {0.86, 1.0, 1.24, 1.7, 2.1, 2.45})
        for (const double unit : {1.0, 0.01, 0.001}) EXPECT_EQ(motion::likely_unit(height_m / unit), unit) << height_m;
    for (const double height_m : {1.5, 1.7, 2.1}) EXPECT_EQ(motion::likely_unit(height_m / kInch), kInch) << height_m;
    EXPECT_NEAR(motion::likely_unit(30), 0.0564, 0.001) << "CMU's";
    EXPECT_EQ(motion::likely_unit(0.5), 1) << "a doll in metres";
    EXPECT_EQ(motion::likely_unit(5), 1) << "a giant in metres";
}

TEST(SkeletonSpace, AChildKeepsItsSize) {
    const TemporaryFolder folder;
    const double scale = 1 / test::height_of(standing_dancer());
    const motion::SkeletonClip child = test::other_body(standing_dancer(), scale, {}, 0);
    motion::write_bvh(folder.path / "child.bvh", child, 100);
    const motion::SkeletonClip read = motion::read_skeleton(folder.path / "child.bvh");
    EXPECT_NEAR(test::height_of(read), 1, 0.01);
    EXPECT_TRUE(read.notes.empty());
    const auto height = [&](const motion::SkeletonReading& reading) {
        return test::height_of(motion::read_skeleton(folder.path / "child.bvh", reading));
    };
    EXPECT_NEAR(height({.unit_m = 0.0254}), 2.54, 0.02);
    EXPECT_NEAR(height({.height_m = 1.31}), 1.31, 0.02);
    // What is odd is said.
    motion::write_bvh(folder.path / "small.bvh", child, 0.2);
    EXPECT_EQ(motion::read_skeleton(folder.path / "small.bvh").notes.at(0).fix.remedy, Remedy::kUnitIfWrong);
}

TEST(SkeletonSpace, ExchangedSidesAreSaid) {
    motion::SkeletonClip clip = standing_dancer();
    for (motion::Pose& pose : clip.frames)
        for (motion::JointSample& sample : pose) sample.position.x *= -1;
    motion::bring_to_metres({.unit_m = 1}, "a", clip);
    ASSERT_EQ(clip.notes.size(), 1u);
    EXPECT_NE(clip.notes[0].text.find("left and right are probably exchanged"), std::string::npos);
}

}  // namespace
}  // namespace neuvv
