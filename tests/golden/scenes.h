// The scenes of the golden pictures, built in code.
#pragma once

#include <string>
#include <vector>

#include "render/frame.h"

namespace neuvv::test {

struct GoldenScene {
    std::string name;
    VOctree tree;
    Camera camera;
    FrameSettings settings;
};

std::vector<GoldenScene> golden_scenes();
Image render_scene(const Device& device, const GoldenScene& scene);

}  // namespace neuvv::test
