// The stages of the golden images, built by the operations of neuvv::edit and rendered as `neuvv render` does.
#pragma once

#include <string>
#include <vector>

#include "gpu/device.h"
#include "media/image.h"

namespace neuvv::test {

struct GoldenStage {
    std::string name;
    media::Image image;
};

// Renders all stages, or only the one named `only`.
std::vector<GoldenStage> golden_stages(const gpu::Device& device, const std::string& only = "");

}  // namespace neuvv::test
