// Cameras of a data set that all look past a scene by the same motion come back to it.
#include "training/rig/align_rig.h"

#include <gtest/gtest.h>

#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/evaluation/evaluate.h"
#include "voctree/files/nvv.h"

namespace neuvv::test {
namespace {

// A clip in a file, and images of it from a ring of cameras.
struct RenderedClip {
    TemporaryFolder folder;
    voctree::ClipIndex clip;
    training::Dataset dataset;

    explicit RenderedClip(const gpu::Device& device) {
        const voctree::VOctree tree = random_tree({.leaves = 300, .frames = 2});
        voctree::write_nvv(folder.path / "clip.nvv", tree);
        clip = voctree::read_clip_index(folder.path / "clip.nvv");
        dataset = sphere_dataset({.cameras = 4, .frames = 2, .size = 64, .distance_m = 5});
        const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
        render::FrameRenderer renderer(device, field, {64, 64, 2});
        for (training::View& view : dataset.views) {
            render::FrameSettings settings;
            settings.instances[0].frame = static_cast<float>(view.time);
            settings.width = settings.height = 64;
            settings.samples = 2;
            settings.mode = render::TraceMode::kTree;
            view.image = training::TiledImage(renderer.render(dataset.cameras[view.camera], settings));
        }
    }
};

class AlignRigTest : public GpuTest {
  protected:
    training::RigAlignment align(const RenderedClip& rendered) {
        double last = 0;
        const training::RigAlignment found =
            training::align_rig(device(), rendered.clip, rendered.dataset, [&](double fraction) {
                EXPECT_GE(fraction, last);
                EXPECT_LE(fraction, 1);
                last = fraction;
                return true;
            });
        return found;
    }
};

// The pixels by which two cameras' images of the scene differ.
double distance_px(const stage::Camera& a, const stage::Camera& b, glm::dvec3 centre) {
    double most = 0;
    for (const glm::dvec3& point : training::scene_points(a, centre))
        most = std::max(most, glm::length(training::seen_at(a, point) - training::seen_at(b, point)));
    return most;
}

TEST_F(AlignRigTest, ARigThatHasMovedComesBack) {
    RenderedClip rendered(device());
    const std::vector<stage::Camera> truth = rendered.dataset.cameras;
    const training::RigMotion spoilt{{0.02, -0.015, 0.01}, {0.02, 0.03, -0.025}, 0.015};
    double before = 0, after = 0;
    for (stage::Camera& camera : rendered.dataset.cameras) camera = training::moved(camera, spoilt, {0.1, 0, 0.2});
    const double psnr_before = training::evaluate(device(), rendered.clip, rendered.dataset, {.samples = 2}).mean.psnr;
    const training::RigAlignment found = align(rendered);
    for (size_t i = 0; i < truth.size(); ++i) {
        stage::Camera& camera = rendered.dataset.cameras[i];
        before = std::max(before, distance_px(truth[i], camera, found.centre));
        camera = training::moved(camera, found.motion, found.centre);
        after = std::max(after, distance_px(truth[i], camera, found.centre));
    }
    EXPECT_GT(before, 1);
    EXPECT_GT(found.motion_px, 0.5);
    EXPECT_LT(after, 0.15);
    EXPECT_GT(training::evaluate(device(), rendered.clip, rendered.dataset, {.samples = 2}).mean.psnr, psnr_before + 6);
}

TEST_F(AlignRigTest, ARigThatFitsStays) {
    const RenderedClip rendered(device());
    EXPECT_LT(align(rendered).motion_px, 0.1);
}

// One camera alone has a place to come back to, too, though some of its motions look alike.
TEST_F(AlignRigTest, OneCameraIsEnough) {
    RenderedClip rendered(device());
    std::erase_if(rendered.dataset.views, [](const training::View& view) { return view.camera != 0; });
    rendered.dataset.cameras.resize(1);
    const training::RigMotion spoilt{{0, 0, 0}, {0.03, 0.04, 0}, 0};
    const stage::Camera truth = rendered.dataset.cameras[0];
    stage::Camera& camera = rendered.dataset.cameras[0];
    camera = training::moved(truth, spoilt, glm::dvec3(0));
    const training::RigAlignment found = align(rendered);
    const double before = distance_px(truth, camera, found.centre);
    EXPECT_LT(distance_px(truth, training::moved(camera, found.motion, found.centre), found.centre), 0.3 * before);
}

TEST_F(AlignRigTest, StopsWhereItsCallbackSaysSo) {
    const RenderedClip rendered(device());
    const auto stop = [](double) { return false; };
    EXPECT_LT(training::align_rig(device(), rendered.clip, rendered.dataset, stop).motion_px, 1e-9);
}

TEST(RigMotion, TurnsMovesAndScalesAboutTheCentre) {
    const SphereCapture capture;
    const stage::Camera camera = sphere_camera(capture, 2);
    const glm::dvec3 centre(0.3, -0.2, 0.1), shift(1, 2, 3);
    const stage::Camera moved = training::moved(camera, {{0, 0.5, 0}, shift, std::log(2.0)}, centre);
    const glm::dvec3 arm = glm::dvec3(camera.world_from_camera[3]) - centre;
    const glm::dvec3 expected(std::cos(0.5) * arm.x + std::sin(0.5) * arm.z, arm.y,
                              -std::sin(0.5) * arm.x + std::cos(0.5) * arm.z);
    EXPECT_LT(glm::length(glm::dvec3(moved.world_from_camera[3]) - (centre + 2.0 * expected + shift)), 1e-12);
    EXPECT_EQ(moved.fx, camera.fx);
    // A camera keeps what it sees of the centre where nothing is shifted.
    const stage::Camera turned = training::moved(camera, {{0.1, 0.2, 0.3}, glm::dvec3(0), 0.1}, centre);
    EXPECT_LT(glm::length(training::seen_at(turned, centre) - training::seen_at(camera, centre)), 1e-9);
}

}  // namespace
}  // namespace neuvv::test
