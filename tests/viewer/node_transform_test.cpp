#include "tools/viewer/panels/node_transform.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/near.h"
#include "tests/stage/stage_files.h"

namespace neuvv {
namespace {

using test::expect_near;

double distance(const glm::dquat& a, const glm::dquat& b) {
    return 1 - std::abs(glm::dot(a, b));
}

struct NodePlaces : testing::Test {
    TemporaryFolder folder;
    stage::StageFile file = stage::read_stage_file(test::put_foreign_stage(folder.path));
    uint32_t node(const char* name) const { return edit::find_node(file, name); }
    void move_to(const char* name, const edit::NodeTransform& to) {
        edit::place_node(file, node(name), viewer::placement_to(edit::transform_of(file, node(name)), to));
    }
};

TEST(Angles, TurnAboutXThenYThenZ) {
    expect_near(viewer::rotation_of({90, 90, 0}) * glm::dvec3(0, 1, 0), {1, 0, 0});  // Y to Z by X, Z to X by Y
    expect_near(viewer::rotation_of({0, 90, 90}) * glm::dvec3(1, 0, 0), {0, 0, -1});
    expect_near(viewer::rotation_of({0, 0, 90}) * glm::dvec3(1, 0, 0), {0, 1, 0});
}

TEST(Angles, ComeBackFromEveryTurn) {
    for (double x = -170; x <= 180; x += 35)
        for (double y = -90; y <= 90; y += 15)
            for (double z = -170; z <= 180; z += 35) {
                const glm::dquat rotation = viewer::rotation_of({x, y, z});
                const glm::dvec3 angles = viewer::angles_of(rotation);
                EXPECT_LT(distance(viewer::rotation_of(angles), rotation), 1e-12) << x << ' ' << y << ' ' << z;
                EXPECT_LE(std::abs(angles.y), 90);
                if (std::abs(y) < 90) expect_near(angles, {x, y, z}, 1e-7);
            }
}

TEST(Angles, StayAsShownWhileTheyMeanTheSame) {
    const glm::dvec3 beyond(10, 120, -400);
    expect_near(viewer::angles_like(beyond, viewer::rotation_of(beyond)), beyond, 1e-15);
    const glm::dquat other = viewer::rotation_of({10, 120.01, -400});
    const glm::dvec3 angles = viewer::angles_like(beyond, other);
    EXPECT_LE(std::abs(angles.y), 90);
    EXPECT_LT(distance(viewer::rotation_of(angles), other), 1e-12);
}

TEST_F(NodePlaces, APlaceOfPartsIsReadAndReached) {
    const edit::NodeTransform before = edit::transform_of(file, node("Anna"));
    expect_near(viewer::angles_of(before.rotation), {0, 0, 45}, 1e-6);
    const edit::NodeTransform to{{1, 2, 3}, viewer::rotation_of({20, -100, 70}), {2, 1, -0.5}};
    move_to("Anna", to);
    const edit::NodeTransform after = edit::transform_of(file, node("Anna"));
    expect_near(after.translation, to.translation);
    expect_near(after.scale, to.scale);
    EXPECT_LT(distance(after.rotation, to.rotation), 1e-12);
    EXPECT_FALSE(file.json["nodes"][node("Anna")].contains("matrix"));
}

TEST_F(NodePlaces, OnlyWhatDiffersIsPlaced) {
    edit::NodeTransform from;
    edit::NodeTransform to = from;
    to.translation.x = 1;
    EXPECT_TRUE(viewer::placement_to(from, to).at);
    EXPECT_FALSE(viewer::placement_to(from, to).turn_deg);
    EXPECT_FALSE(viewer::placement_to(from, to).scale);
    from.scale = {0, 2, 1};
    to.scale = {3, 1, 1};
    expect_near(viewer::placement_to(from, to).scale.value(), {1, 0.5, 1});
}

TEST_F(NodePlaces, AMatrixIsReadAndReached) {
    edit::NodeTransform transform{{0.5, 1, -2}, viewer::rotation_of({30, 40, 50}), {-1.5, 2, 0.25}};
    glm::dmat4 matrix = glm::mat4_cast(transform.rotation);
    for (int axis = 0; axis < 3; ++axis) matrix[axis] *= transform.scale[axis];
    matrix[3] = glm::dvec4(transform.translation, 1);
    edit::Placement placement;
    placement.matrix = matrix;
    edit::place_node(file, node("Anna"), placement);
    for (const edit::NodeTransform& to :
         {transform, edit::NodeTransform{{3, 2, 1}, viewer::rotation_of({0, 170, 0}), {-1, 1, 1}}}) {
        move_to("Anna", to);
        ASSERT_TRUE(file.json["nodes"][node("Anna")].contains("matrix"));
        const edit::NodeTransform after = edit::transform_of(file, node("Anna"));
        expect_near(after.translation, to.translation);
        expect_near(after.scale, to.scale);
        EXPECT_LT(distance(after.rotation, to.rotation), 1e-12);
    }
}

TEST(Scales, KeepTheirSignAndStayOffZero) {
    expect_near(viewer::nonzero_scale({0.5, -2, 0}, {1, -1, 0}), {0.5, -2, 0});
    expect_near(viewer::nonzero_scale({-0.5, 0.1, 0}, {1, -1, 1}),
                {viewer::kMinScale, -viewer::kMinScale, viewer::kMinScale});
}

// The height of the lowest corner of Anna's box, in metres of the world. Only the part of the box above her own floor
// counts.
double height_of_anna(const stage::StageFile& file) {
    const stage::Stage stage = stage::make_stage(file);
    const stage::StageClip& clip = stage.clips.at(0);
    EXPECT_LT(clip.box_min.y, 0);
    const glm::dmat4 world = stage::stage_at(stage, 0).performers.at(0).world_from_performer;
    double lowest = INFINITY;
    for (const double x : {clip.box_min.x, clip.box_min.x + clip.box_size.x})
        for (const double y : {0.0, clip.box_min.y + clip.box_size.y})
            for (const double z : {clip.box_min.z, clip.box_min.z + clip.box_size.z})
                lowest = std::min(lowest, (world * glm::dvec4(x, y, z, 1)).y);
    return lowest;
}

TEST_F(NodePlaces, TheLowestOfAllThatHangsOnANodeComesToTheFloor) {
    // Anna is rotated by 45° about Z; her parent is Pivot, which is scaled along X.
    edit::Placement tilted;
    tilted.at = glm::dvec3(1, 0.7, 0);
    tilted.turn_deg = glm::dvec3(0, 0, 90);
    edit::place_node(file, node("Pivot"), tilted);
    for (const char* name : {"Anna", "Pivot"}) {
        const stage::Stage stage = stage::make_stage(file);
        edit::Placement placement;
        placement.move = viewer::move_to_floor(stage, stage::stage_at(stage, 0), node(name));
        ASSERT_TRUE(placement.move) << name;
        stage::StageFile moved = file;
        EXPECT_GT(std::abs(height_of_anna(moved)), 0.01);
        edit::place_node(moved, node(name), placement);
        EXPECT_NEAR(height_of_anna(moved), 0, 1e-9) << name;
    }
}

TEST_F(NodePlaces, APerformerStandsOnTheFloorItWasCapturedOn) {
    edit::Placement up;
    up.matrix = glm::dmat4(1);
    up.move = glm::dvec3(3, 0.5, 0);
    edit::place_node(file, node("Anna"), up);
    const stage::Stage stage = stage::make_stage(file);
    const auto move = viewer::move_to_floor(stage, stage::stage_at(stage, 0), node("Anna"));
    ASSERT_TRUE(move);
    expect_near(*move, {0, -0.5, 0});
}

TEST_F(NodePlaces, AMeshComesToTheFloorAndACameraDoesNot) {
    edit::Placement up;
    up.at = glm::dvec3(1, 3, 2);
    edit::place_node(file, node("Floor"), up);
    const stage::Stage stage = stage::make_stage(file);
    const stage::EvaluatedStage evaluated = stage::stage_at(stage, 0);
    const auto move = viewer::move_to_floor(stage, evaluated, node("Floor"));
    ASSERT_TRUE(move);
    expect_near(*move, {0, -3, 0}, 1e-6);
    EXPECT_FALSE(viewer::move_to_floor(stage, evaluated, node("Camera")));
}

}  // namespace
}  // namespace neuvv
