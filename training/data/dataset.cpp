#include "training/data/dataset.h"

#include <algorithm>
#include <cmath>

#include "base/platform.h"
#include "training/data/images.h"
#include "training/data/layouts/formats.h"

namespace neuvv::training {

namespace {

uint8_t byte_from_unit(double value) {
    return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
}

}  // namespace

Dataset load_dataset(const std::filesystem::path& folder, Split split, const LoadOptions& options) {
    return read_images(read_rig(folder, split, options.format, options.holdout), options);
}

bool has_mattes(const Dataset& dataset) {
    return std::ranges::any_of(dataset.views, [](const View& view) {
        for (uint32_t y = 0; y < view.image.height(); ++y)
            for (uint32_t x = 0; x < view.image.width(); ++x)
                if (view.image.at(x, y)[3] < 255 && !view.ignores(x, y)) return true;
        return false;
    });
}

void change_frame(Dataset& dataset, const voctree::WorldFrame& frame) {
    if (dataset.frame == frame) return;
    const auto moved = [&](const glm::dvec3& p) { return frame.from_capture(dataset.frame.to_capture(p)); };
    for (stage::Camera& camera : dataset.cameras)
        camera.world_from_camera = frame.pose_from_capture(dataset.frame.pose_to_capture(camera.world_from_camera));
    if (dataset.box) dataset.box = {moved(dataset.box->first), moved(dataset.box->second)};
    dataset.frame = frame;
}

uint64_t image_budget() {
    return std::max<uint64_t>(available_memory_bytes() / 2, 1);
}

double frame_of_time(double time, uint32_t frames) {
    const double frame = time * (frames - 1), whole = std::round(frame);
    return std::abs(frame - whole) < 1e-3 ? whole : frame;
}

uint64_t image_bytes(const Dataset& dataset) {
    uint64_t bytes = 0;
    for (const View& view : dataset.views) bytes += view.image.bytes();
    return bytes;
}

glm::vec4 foreground(const Dataset& dataset, const View& view, uint32_t x, uint32_t y) {
    const auto rgb = [](const uint8_t* at) {
        return glm::vec3(media::linear_from_srgb_byte(at[0]), media::linear_from_srgb_byte(at[1]),
                         media::linear_from_srgb_byte(at[2]));
    };
    const uint8_t* pixel = view.image.at(x, y);
    const float alpha = static_cast<float>(pixel[3]) / 255.0f;
    const media::Image& plate = dataset.plates[view.camera];
    if (plate.width == 0) return {rgb(pixel) * alpha, alpha};
    // captured = foreground + (1 − α) background
    const glm::vec3 premultiplied = rgb(pixel) - (1 - alpha) * rgb(plate.at(x, y));
    return {glm::clamp(premultiplied, 0.0f, alpha), alpha};
}

media::Image truth_over(const Dataset& dataset, const View& view, const uint8_t background[3]) {
    if (dataset.plates[view.camera].width == 0) return media::composite_over(view.image.whole(), background);
    media::Image clear(view.image.width(), view.image.height());
    for (uint32_t y = 0; y < clear.height; ++y)
        for (uint32_t x = 0; x < clear.width; ++x) {
            const glm::vec4 light = foreground(dataset, view, x, y);
            if (light.a <= 0) continue;
            uint8_t* pixel = clear.at(x, y);
            for (int c = 0; c < 3; ++c)
                pixel[c] = byte_from_unit(media::srgb_from_linear(std::min(1.0, double{light[c]} / double{light.a})));
            pixel[3] = byte_from_unit(double{light.a});
        }
    return media::composite_over(clear, background);
}

}  // namespace neuvv::training
