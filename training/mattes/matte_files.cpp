#include "training/mattes/matte_files.h"

#include <algorithm>

#include "training/data/contact_sheet.h"
#include "training/data/mask_image.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kSheetCell = 320;
constexpr uint8_t kMagenta[3] = {255, 0, 255};

// Which share of the pixels along the image's borders is white.
double white_borders_of(const std::vector<uint8_t>& matte, uint32_t width, uint32_t height) {
    uint64_t white = 0, all = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; x += y == 0 || y + 1 == height || width < 2 ? 1 : width - 1) {
            white += matte[size_t{y} * width + x] >= 128;
            ++all;
        }
    return all > 0 ? static_cast<double>(white) / static_cast<double>(all) : 0;
}

// Image, matte, and the performer over magenta, small.
std::vector<media::Image> row_of_sheet(const media::Image& image, const media::Image& grey) {
    media::Image opaque = image, cut = image;
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        opaque.rgba[i + 3] = 255;
        cut.rgba[i + 3] = grey.rgba[i];
    }
    std::vector<media::Image> row;
    for (const media::Image& cell : {opaque, grey, media::composite_over(cut, kMagenta)})
        row.push_back(scaled_to_fit(cell, kSheetCell));
    return row;
}

}  // namespace

void MatteFiles::add(const std::string& camera, const std::string& name, const media::Image& image,
                     const std::vector<uint8_t>& matte) {
    const media::Image grey = grey_image(image, [&](size_t i) { return matte[i]; });
    media::write_png(folder_ / (name + ".png"), grey);
    ++count_;
    shows_performer_ = shows_performer_ || std::ranges::any_of(matte, [](uint8_t value) { return value >= 128; });
    white_borders_ += white_borders_of(matte, image.width, image.height);
    if (rows_.contains(camera)) return;
    cameras_.push_back(camera);
    rows_[camera] = row_of_sheet(image, grey);
}

std::vector<std::string> MatteFiles::write_sheet(const std::vector<std::string>& first) const {
    if (cameras_.empty()) return {};
    std::vector<std::string> order = cameras_;
    std::ranges::stable_sort(order, {}, [&](const std::string& camera) { return std::ranges::find(first, camera); });
    std::vector<media::Image> cells;
    for (const std::string& camera : order)
        for (const media::Image& cell : rows_.at(camera)) cells.push_back(cell);
    media::write_png(folder_ / (std::string(kMatteSheetName) + ".png"), contact_sheet(cells, 3, kSheetCell));
    return order;
}

}  // namespace neuvv::training
