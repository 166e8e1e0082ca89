// The sets of the golden images, built in code.
#pragma once

#include <string>
#include <vector>

#include "render/set/set_raster.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::test {

struct GoldenSet {
    std::string name;
    stage::GltfScene scene;
    media::Image environment;  // empty: none
    stage::Camera camera;
    std::vector<render::SetLight> lights;
    render::SetAmbient ambient;
    float volume_depth_m = 0;  // of an assumed volume over the right half of the image; 0: none
};

std::vector<GoldenSet> golden_sets();
// Renders with four texels a pixel, and composites front over colour.
media::Image render_set(const gpu::Device& device, const GoldenSet& set);

}  // namespace neuvv::test
