// The image around a stage as light: what diffuse surfaces return of it, and what rough ones mirror.
#pragma once

#include <vector>

#include "media/image.h"
#include "render/set_lights.h"

namespace neuvv::render {

struct Environment {
    Irradiance irradiance{};
    uint32_t width = 1, height = 1;  // of the first level
    std::vector<std::vector<uint16_t>>
        levels;  // RGBA as binary16, linear; level i: as roughness i / (levels − 1) mirrors
};

// `image`: equirectangular, sRGB, opaque, the middle towards −Z and the top +Y; it is taken down to at most 2048
// pixels across. That much takes about a second.
Environment make_environment(const media::Image& image);

// No light.
Environment dark_environment();

// Where the texel at (u, v) in [0,1]² lies.
glm::dvec3 environment_direction(double u, double v);

}  // namespace neuvv::render
