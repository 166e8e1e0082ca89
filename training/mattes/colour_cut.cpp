#include "training/mattes/colour_cut.h"

#include <algorithm>
#include <cassert>
#include <opencv2/imgproc.hpp>

namespace neuvv::training {

namespace {

constexpr uint32_t kMargin = 24;  // pixels of background around what is possible, whose colours are learnt
constexpr int kCutRounds = 2;     // of learning colours and cutting
constexpr int kMinPixels = 50;    // of figure and of background
constexpr uint64_t kSeed = 1;     // of the first means of colours, so that a second run gives the same

// Around all pixels of the mask; empty where there are none.
cv::Rect rectangle_around(const PixelMask& mask, uint32_t margin) {
    uint32_t left = mask.width, right = 0, top = mask.height, bottom = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (!mask[i]) continue;
        const auto x = static_cast<uint32_t>(i % mask.width), y = static_cast<uint32_t>(i / mask.width);
        left = std::min(left, x);
        right = std::max(right, x + 1);
        top = std::min(top, y);
        bottom = std::max(bottom, y + 1);
    }
    if (left >= right) return {};
    left -= std::min(left, margin);
    top -= std::min(top, margin);
    right = std::min(mask.width, right + margin);
    bottom = std::min(mask.height, bottom + margin);
    return {static_cast<int>(left), static_cast<int>(top), static_cast<int>(right - left),
            static_cast<int>(bottom - top)};
}

uint8_t class_of(const FigureBounds& bounds, size_t pixel) {
    if (!bounds.possible[pixel]) return cv::GC_BGD;
    if (bounds.sure[pixel]) return cv::GC_FGD;
    return bounds.probable[pixel] ? cv::GC_PR_FGD : cv::GC_PR_BGD;
}

bool is_figure(uint8_t pixel_class) {
    return pixel_class == cv::GC_FGD || pixel_class == cv::GC_PR_FGD;
}

}  // namespace

PixelMask cut_by_colour(const media::Image& image, const FigureBounds& bounds) {
    assert(image.rgba.size() == 4 * bounds.possible.size() && "one size");
    PixelMask figure(image.width, image.height);
    const cv::Rect part = rectangle_around(bounds.possible, kMargin);
    if (part.empty()) return figure;
    cv::Mat colours(part.height, part.width, CV_8UC3), classes(part.height, part.width, CV_8UC1);
    const auto pixel_of = [&](int x, int y) {
        return static_cast<size_t>(part.y + y) * image.width + static_cast<size_t>(part.x + x);
    };
    int figures = 0;
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) {
            const uint8_t* rgba = &image.rgba[4 * pixel_of(x, y)];
            colours.at<cv::Vec3b>(y, x) = {rgba[2], rgba[1], rgba[0]};
            const uint8_t pixel_class = class_of(bounds, pixel_of(x, y));
            classes.at<uint8_t>(y, x) = pixel_class;
            figures += is_figure(pixel_class);
        }
    if (figures >= kMinPixels && part.area() - figures >= kMinPixels) {
        cv::theRNG().state = kSeed;
        cv::Mat background_model, figure_model;
        cv::grabCut(colours, classes, {}, background_model, figure_model, kCutRounds, cv::GC_INIT_WITH_MASK);
    }
    for (int y = 0; y < part.height; ++y)
        for (int x = 0; x < part.width; ++x) figure.set[pixel_of(x, y)] = is_figure(classes.at<uint8_t>(y, x));
    return figure;
}

}  // namespace neuvv::training
