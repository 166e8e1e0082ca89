#include "training/data/reduce.h"

#include <algorithm>
#include <cassert>

namespace neuvv::training {

media::Image reduced(const media::Image& image, uint32_t side) {
    assert(side > 0 && image.width >= side && image.height >= side && "something is left of the image");
    media::Image result(image.width / side, image.height / side);
    const uint64_t count = uint64_t{side} * side;
    for (uint32_t y = 0; y < result.height; ++y)
        for (uint32_t x = 0; x < result.width; ++x) {
            uint64_t sums[4] = {}, weighted[3] = {};
            for (uint32_t v = 0; v < side; ++v)
                for (uint32_t u = 0; u < side; ++u) {
                    const uint8_t* pixel = image.at(side * x + u, side * y + v);
                    for (size_t c = 0; c < 4; ++c) sums[c] += pixel[c];
                    for (size_t c = 0; c < 3; ++c) weighted[c] += uint64_t{pixel[c]} * pixel[3];
                }
            uint8_t* pixel = result.at(x, y);
            const auto mean = [](uint64_t sum, uint64_t of) { return static_cast<uint8_t>((sum + of / 2) / of); };
            for (size_t c = 0; c < 3; ++c) pixel[c] = sums[3] > 0 ? mean(weighted[c], sums[3]) : mean(sums[c], count);
            pixel[3] = mean(sums[3], count);
        }
    return result;
}

std::vector<bool> reduced(const std::vector<bool>& ignored, media::ImageSize size, uint32_t side) {
    if (ignored.empty()) return {};
    const uint32_t width = size.width / side, height = size.height / side;
    std::vector<bool> result(size_t{width} * height);
    for (uint32_t y = 0; y < height * side; ++y)
        for (uint32_t x = 0; x < width * side; ++x)
            if (ignored[size_t{y} * size.width + x]) result[size_t{y / side} * width + x / side] = true;
    return result;
}

stage::Camera reduced(const stage::Camera& camera, uint32_t side) {
    stage::Camera result = camera;
    result.width /= side;
    result.height /= side;
    for (double* value : {&result.fx, &result.fy, &result.cx, &result.cy}) *value /= side;
    return result;
}

}  // namespace neuvv::training
