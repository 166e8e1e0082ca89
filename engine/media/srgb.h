// The sRGB transfer function (IEC 61966-2-1) and its inverse.
#pragma once

#include <cstdint>

namespace neuvv::media {

// On values in [0,1].
double srgb_from_linear(double linear);
double linear_from_srgb(double srgb);
float linear_from_srgb_byte(uint8_t srgb);    // by table
uint8_t srgb_byte_from_linear(float linear);  // clamped to [0,1], rounded to nearest; by table

}  // namespace neuvv::media
