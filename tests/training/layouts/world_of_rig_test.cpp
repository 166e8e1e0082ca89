// Captures far from the origin, very small and very large ones.
#include "training/data/layouts/rig/world_of_rig.h"

#include <gtest/gtest.h>

#include "interchange/camera/camera_path_file.h"
#include "support/input_error.h"
#include "support/sphere_capture.h"
#include "training/data/dataset.h"
#include "training/data/layouts/formats.h"
#include "voctree/files/world_frame.h"

namespace neuvv {
namespace {

using training::Split;
using voctree::WorldFrame;

// The capture of a sphere at another place, and scaled.
struct Placed : testing::Test {
    TemporaryFolder folder;
    const training::Dataset near = test::sphere_dataset({.cameras = 5, .frames = 1, .size = 16});

    training::Dataset load(const glm::dvec3& at, double scale, const std::string& split = "train") const {
        training::Dataset moved = near;
        for (stage::Camera& camera : moved.cameras)
            camera.world_from_camera[3] = glm::dvec4(scale * glm::dvec3(camera.world_from_camera[3]) + at, 1);
        test::write_capture(folder.path, moved);
        if (split == "test") {  // of which one camera is held out
            std::filesystem::rename(folder.path / "transforms_train.json", folder.path / "transforms.json");
            return training::load_dataset(folder.path, Split::kTest);
        }
        return training::load_dataset(folder.path, Split::kTrain);
    }
    static double worst(const training::Dataset& a, const training::Dataset& b, const glm::dvec3& shift = {}) {
        double most = 0;
        for (size_t i = 0; i < a.cameras.size(); ++i)
            for (int column = 0; column < 4; ++column)
                for (int row = 0; row < 3; ++row)
                    most = std::max(
                        most, std::abs(a.cameras[i].world_from_camera[column][row] -
                                       b.cameras[i].world_from_camera[column][row] - (column == 3 ? shift[row] : 0)));
        return most;
    }
};

TEST_F(Placed, UsualCapturesStayWhereTheyAre) {
    for (const double scale : {0.1, 1.0, 100.0, 1000.0})
        for (const double away : {0.0, 50.0 * scale}) {
            const training::Dataset loaded = load(glm::dvec3(away, 0, 0), scale);
            EXPECT_TRUE(loaded.frame.is_same()) << scale << " " << away;
        }
    EXPECT_TRUE(training::read_rig(folder.path, Split::kTrain).remarks.empty());
}

TEST_F(Placed, FarCapturesComeToTheOrigin) {
    const training::Dataset far = load({400000, 0, 300000}, 1);
    EXPECT_EQ(far.frame, (WorldFrame{{400000, 0, 300000}, 1}));
    EXPECT_LT(worst(far, near), 1e-9);
    const training::Rig rig = training::read_rig(folder.path, Split::kTrain);
    ASSERT_EQ(rig.remarks.size(), 1u);
    EXPECT_EQ(rig.remarks[0].find("the capture's (400000, 0, 300000) becomes the clip's origin"), 0u) << rig.remarks[0];
    // A northing of UTM, and an easting that is no round number.
    const training::Dataset utm = load({512345.678, 412.5, -5403210.9}, 1);
    EXPECT_EQ(utm.frame, (WorldFrame{{512350, 410, -5403210}, 1}));
    EXPECT_LT(worst(utm, near, {-4.322, 2.5, -0.9}), 1e-8);
    expect_input_error([&] { load({0, 0, 2e8}, 1); }, {"frames[0].transform_matrix", "from the origin"});
}

TEST_F(Placed, SmallAndLargeCapturesGetAMetre) {
    for (const double scale : {1e-5, 1e-3, 1e5}) {
        const training::Dataset loaded = load({}, scale);
        EXPECT_EQ(loaded.frame, (WorldFrame{{0, 0, 0}, scale})) << scale;
        EXPECT_LT(worst(loaded, near), 1e-9) << scale;
    }
    const training::Dataset both = load({1, 0, 0}, 1e-5);
    EXPECT_EQ(both.frame, (WorldFrame{{1, 0, 0}, 1e-5}));
    EXPECT_LT(worst(both, near), 1e-9);
}

TEST_F(Placed, AllSplitsHaveOneFrame) {
    const training::Dataset held_out = load({400001, 7, 300002}, 1, "test");
    const training::Dataset train = training::load_dataset(folder.path, Split::kTrain);
    EXPECT_EQ(held_out.cameras.size(), 1u);
    EXPECT_EQ(held_out.frame, train.frame);
    for (const char* holdout : {"0", "2", "c03_f000"})
        EXPECT_EQ(training::read_rig(folder.path, Split::kTrain, "auto", holdout).frame, train.frame);
}

TEST_F(Placed, ACameraThatIsCalibratedWronglyCountsLittle) {
    std::vector<glm::dmat4> poses;
    for (const stage::Camera& camera : near.cameras) poses.push_back(camera.world_from_camera);
    poses[0][3] = {1e7, 0, 0, 1};
    EXPECT_TRUE(training::world_of(poses, {}).is_same());
}

// Two cameras beside each other, 5 m from what both see: their distance says nothing of the capture's size.
TEST_F(Placed, APairOfCamerasIsAsLargeAsWhatItSees) {
    const std::vector<glm::dmat4> poses = {test::look_at({-0.02, 0, 5}, {0, 0, 0}, 8, 8, 1).world_from_camera,
                                           test::look_at({0.02, 0.01, 5}, {0, 0, 0}, 8, 8, 1).world_from_camera};
    EXPECT_GT(glm::distance(glm::dvec3(poses[0][3]), glm::dvec3(poses[1][3])), 0.04);
    const std::pair<glm::dvec3, glm::dvec3> box = {{-1, -1, -1}, {1, 1, 1}};
    EXPECT_TRUE(training::world_of(poses, box).is_same());
}

TEST_F(Placed, AClipIsMeasuredInItsOwnFrame) {
    training::Dataset far = load({400000, 0, 300000}, 1);
    training::change_frame(far, {{400010, 0, 299990}, 2});
    EXPECT_NEAR(far.cameras[0].world_from_camera[3].x, (near.cameras[0].world_from_camera[3].x - 10) / 2, 1e-9);
    training::change_frame(far, {});  // a clip that was trained far from the origin
    EXPECT_NEAR(far.cameras[0].world_from_camera[3].z, near.cameras[0].world_from_camera[3].z + 300000, 1e-9);
}

TEST_F(Placed, CameraPathsHaveTheCapturesCoordinates) {
    load({400000, 0, 300000}, 1);
    const WorldFrame frame{{400000, 0, 300000}, 1};
    const stage::CameraPath path = interchange::read_camera_path(folder.path / "transforms_train.json", 25, frame);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(path.keys[2].position[axis], near.cameras[2].world_from_camera[3][axis], 1e-9);
    interchange::write_camera_path(folder.path / "path.json", interchange::in_capture(path, frame));
    EXPECT_NEAR(interchange::read_camera_path(folder.path / "path.json", 25).keys[2].position.x,
                400000 + near.cameras[2].world_from_camera[3].x, 1e-9);
}

}  // namespace
}  // namespace neuvv
