// Where the one person of an image is, and that part of the image at the size that a detector wants.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "media/image.h"

namespace neuvv::motion {

// Pixel (0, 0) covers 0 to 1 of both axes; y down.
struct PixelBox {
    glm::dvec2 low{0}, high{0};
};

// The box around the performer: around what is not transparent; in an opaque image whose border has one colour, around
// what has another; else the whole image. Nothing where the image shows the background alone.
std::optional<PixelBox> person_box(const media::Image& image);

struct PersonCrop {
    uint32_t width = 0, height = 0;
    std::vector<float> rgb;  // three planes of rows, sRGB-encoded, 0 to 255
    glm::dvec2 corner{0};    // of the image, where the crop's (0, 0) lies
    double scale = 1;        // pixels of the image for one of the crop

    // Where a point of the crop lies in the image; both have pixel centres at +½.
    glm::dvec2 image_pixel(const glm::dvec2& crop_pixel) const { return corner + scale * crop_pixel; }
};

// The box with a quarter more around it (as detectors are trained), in the centre of width × height pixels. Its shape
// is kept; transparent pixels are grey, and so is what lies beyond the image, unless its border has one colour.
PersonCrop crop_person(const media::Image& image, const PixelBox& box, uint32_t width, uint32_t height);

}  // namespace neuvv::motion
