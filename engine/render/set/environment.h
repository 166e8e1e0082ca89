// The environment image of a stage as light: the irradiance of diffuse surfaces, and the blurred images that rough
// surfaces mirror.
#pragma once

#include <vector>

#include "gpu/image.h"
#include "media/image.h"
#include "render/set/set_lights.h"

namespace neuvv::render {

struct Environment {
    Irradiance irradiance{};
    uint32_t width = 1, height = 1;  // of the first level
    // Linear RGBA as binary16. Level i is the image as a surface of roughness i / (number of levels − 1) mirrors it.
    std::vector<std::vector<uint16_t>> levels;
};

// `image` is equirectangular, sRGB and opaque; its centre is in the direction −Z and its top is +Y. An image more than
// 2048 pixels wide is scaled down; one of 2048 pixels takes about a second.
Environment make_environment(const media::Image& image);

// A black environment, which gives no light.
Environment dark_environment();

// An environment on the device. It does not change once it was made.
struct SetEnvironment {
    // `source`: as make_environment's image; null: no light. It is not needed afterwards.
    SetEnvironment(const gpu::Device& device, const media::Image* source);

    gpu::DeviceImage image;
    gpu::Sampler sampler;
    Irradiance irradiance{};
    float last_level = 0;
    bool has_image = false;
};

// The direction (unit) of the point (u, v) in [0,1]² of an environment image, from the upper left corner.
glm::dvec3 environment_direction(double u, double v);

}  // namespace neuvv::render
