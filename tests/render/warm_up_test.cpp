// What a warm-up has compiled is not compiled again when the field is drawn.
#include "render/clips/warm_up.h"

#include <gtest/gtest.h>

#include "render/frame/frame.h"
#include "support/figure.h"

namespace neuvv::test {
namespace {

TEST(WarmUp, ImagesOfAFieldThatWasWarmedUpCompileNothing) {
    const gpu::Device device("", gpu::Validation::kOff);  // which has compiled nothing yet
    const render::Field field = render::upload_far_levels(device, figure_tree());
    render::warm_up(device, field);
    const size_t compiled = device.programs().count();
    EXPECT_GT(compiled, 5u);
    render::FrameRenderer renderer(device, field, {64, 64});
    const stage::Camera camera = figure_camera(64);
    render::FrameSettings settings;
    settings.width = settings.height = 64;
    settings.mode = render::TraceMode::kPlay;
    for (const size_t instances : {1, 2}) {
        settings.instances.resize(instances);
        renderer.draw(std::span(&camera, 1), settings);
    }
    const PickRay ray{glm::vec4(camera.world_from_camera[3]), -glm::vec4(camera.world_from_camera[2])};
    EXPECT_TRUE(renderer.begin_pick(settings.instances[0], std::span(&ray, 1), 0.5f));
    renderer.take_picks();
    EXPECT_EQ(device.programs().count(), compiled);
}

}  // namespace
}  // namespace neuvv::test
