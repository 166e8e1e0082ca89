// Networks in ONNX files that find markers by their colours, and images with such markers: a detector whose truth is
// known.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "media/image.h"
#include "motion/video/key_point_detector.h"

namespace neuvv::test {

struct ColourModel {
    size_t key_points = 17;
    std::vector<uint64_t> input = {1, 3, 384, 288};  // batch, channels, height, width
    motion::PixelScale scale = motion::PixelScale::kImageNet;
    uint64_t pool = 4;          // pixels of the input along a side of a value; 1: none
    bool simcc = false;         // columns and rows instead of heat maps
    bool columns_last = false;  // the order of the two
    std::string first_operation = "Conv";
};
// The bytes of an .onnx file. Key point k answers 1 to its colour and 0 to grey.
std::string onnx_of(const ColourModel& model);

// Draws a soft marker of the key point's colour onto the image. Its centre and its standard deviation are in pixels.
void draw_marker(media::Image& image, size_t key_point, size_t key_points, const glm::dvec2& centre, double deviation);
// An opaque grey image.
media::Image grey_image(uint32_t width, uint32_t height);

}  // namespace neuvv::test
