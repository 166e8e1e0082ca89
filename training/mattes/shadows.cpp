#include "training/mattes/shadows.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace neuvv::training {

namespace {

constexpr float kDarkestShadow = 0.6f;  // of Shade::light: about a third of the light
constexpr float kMostHue = 1;           // of the mean around a pixel, in units of noise
constexpr double kSmallPart = 0.02;     // of the image
// The lengths below are for images of so many pixels along the longer side. In larger ones more pixels are averaged,
// and steps from pixel to pixel are smaller.
constexpr double kSideOfLengths = 640;
constexpr double kAround = 2;    // pixels beside and above, over which light and hue are averaged
constexpr double kStep = 0.008;  // of the mean light from one pixel to the next

}  // namespace

PixelMask soft_shadows(const PixelMask& background, const std::vector<Shade>& shades) {
    static_assert(sizeof(Shade) == 4 * sizeof(float), "four channels of an image");
    assert(shades.size() == background.size() && "a shade of each pixel");
    const cv::Mat given(static_cast<int>(background.height), static_cast<int>(background.width), CV_32FC4,
                        const_cast<Shade*>(shades.data()));
    const double scale = std::max(background.width, background.height) / kSideOfLengths;
    const int side = 2 * static_cast<int>(std::max(kAround, std::round(kAround * scale))) + 1;
    const auto step = static_cast<float>(kStep / scale);
    cv::Mat mean;
    cv::blur(given, mean, {side, side});
    const auto* around = mean.ptr<Shade>();
    PixelMask reached =
        without_specks(background, static_cast<size_t>(kSmallPart * static_cast<double>(background.size())));
    std::vector<size_t> open;
    for (size_t i = 0; i < reached.size(); ++i)
        if (reached[i]) open.push_back(i);
    while (!open.empty()) {
        const size_t at = open.back();
        open.pop_back();
        for_each_neighbour(reached, at, false, [&](size_t next) {
            const Shade& shade = around[next];
            if (reached[next] || shade.light > 1 || shade.light < kDarkestShadow) return;
            if (std::max({std::abs(shade.hue[0]), std::abs(shade.hue[1]), std::abs(shade.hue[2])}) > kMostHue) return;
            if (std::abs(shade.light - around[at].light) > step) return;
            reached.set[next] = 1;
            open.push_back(next);
        });
    }
    for (size_t i = 0; i < reached.size(); ++i) reached.set[i] &= !background[i];
    return reached;
}

}  // namespace neuvv::training
