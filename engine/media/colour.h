// The sRGB transfer function (image.h) on colours, channel by channel.
#pragma once

#include <glm/vec3.hpp>

#include "media/image.h"

namespace neuvv::media {

inline glm::dvec3 srgb_from_linear(glm::dvec3 linear) {
    return {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
}

inline glm::dvec3 linear_from_srgb(glm::dvec3 srgb) {
    return {linear_from_srgb(srgb.x), linear_from_srgb(srgb.y), linear_from_srgb(srgb.z)};
}

}  // namespace neuvv::media
