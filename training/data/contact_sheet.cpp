#include "training/data/contact_sheet.h"

#include <algorithm>
#include <cassert>

#include "training/data/reduce.h"

namespace neuvv::training {

namespace {

media::Image enlarged(const media::Image& opaque, uint32_t factor) {
    media::Image large(opaque.width * factor, opaque.height * factor);
    for (uint32_t y = 0; y < large.height; ++y)
        for (uint32_t x = 0; x < large.width; ++x) std::copy_n(opaque.at(x / factor, y / factor), 4, large.at(x, y));
    return large;
}

}  // namespace

media::Image scaled_to_fit(const media::Image& image, uint32_t longest) {
    assert(longest > 0 && "an image is fitted into pixels");
    const uint32_t side = std::max({image.width, image.height, 1u});
    const media::Image opaque = media::composite_over(image, media::kWhite);
    return side > longest ? reduced(opaque, (side + longest - 1) / longest) : enlarged(opaque, longest / side);
}

media::Image contact_sheet(const std::vector<media::Image>& images, uint32_t columns, uint32_t longest) {
    assert(columns > 0 && "a contact sheet has columns");
    columns = std::min(columns, static_cast<uint32_t>(images.size()));
    if (columns == 0) return {};
    const auto rows = static_cast<uint32_t>((images.size() + columns - 1) / columns);
    std::vector<media::Image> fitted;
    uint32_t width = 0, height = 0;  // of a cell
    for (const media::Image& image : images) {
        fitted.push_back(scaled_to_fit(image, longest));
        width = std::max(width, fitted.back().width);
        height = std::max(height, fitted.back().height);
    }
    media::Image sheet(columns * width, rows * height);
    std::fill(sheet.rgba.begin(), sheet.rgba.end(), uint8_t{255});
    for (uint32_t i = 0; i < images.size(); ++i) {
        const media::Image& image = fitted[i];
        const uint32_t left = i % columns * width + (width - image.width) / 2;
        const uint32_t top = i / columns * height + (height - image.height) / 2;
        for (uint32_t y = 0; y < image.height; ++y)
            std::copy_n(image.at(0, y), size_t{4} * image.width, sheet.at(left, top + y));
    }
    return sheet;
}

}  // namespace neuvv::training
