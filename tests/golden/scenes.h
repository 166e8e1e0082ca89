// The scenes of the golden images, built in code.
#pragma once

#include <string>
#include <vector>

#include "render/frame/frame_renderer.h"

namespace neuvv::test {

struct GoldenScene {
    std::string name;
    voctree::VOctree tree;
    stage::Camera camera;
    render::FrameSettings settings;
};

std::vector<GoldenScene> golden_scenes();
media::Image render_scene(const gpu::Device& device, const GoldenScene& scene);

}  // namespace neuvv::test
