#include "training/evaluate.h"

#include <algorithm>
#include <cmath>

#include "render/frame.h"

namespace neuvv {

namespace {

constexpr uint8_t kWhite[3] = {255, 255, 255};

uint8_t byte_from_unit(double value) {
    return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
}

void add(Quality& sum, const Quality& quality) {
    sum.psnr += quality.psnr;
    sum.ssim += quality.ssim;
    sum.mae += quality.mae;
}

Quality divided(const Quality& sum, size_t count) {
    const double n = std::max(1.0, static_cast<double>(count));
    return {sum.psnr / n, sum.ssim / n, sum.mae / n};
}

// Nothing is known of ignored pixels: white in both pictures.
void whiten_ignored(const View& view, Image& picture) {
    for (uint32_t y = 0; y < picture.height && !view.ignored.empty(); ++y)
        for (uint32_t x = 0; x < picture.width; ++x)
            if (view.ignores(x, y)) std::copy(kWhite, kWhite + 3, picture.at(x, y));
}

}  // namespace

Image truth_over_white(const Dataset& dataset, const View& view) {
    if (dataset.plates[view.camera].width == 0) return composite_over(view.image, kWhite);
    Image clear(view.image.width, view.image.height);
    for (uint32_t y = 0; y < clear.height; ++y)
        for (uint32_t x = 0; x < clear.width; ++x) {
            const glm::vec4 light = foreground(dataset, view, x, y);
            if (light.a <= 0) continue;
            uint8_t* pixel = clear.at(x, y);
            for (int c = 0; c < 3; ++c)
                pixel[c] = byte_from_unit(srgb_from_linear(std::min(1.0, double{light[c]} / double{light.a})));
            pixel[3] = byte_from_unit(double{light.a});
        }
    return composite_over(clear, kWhite);
}

Evaluation evaluate(const Device& device, const VOctree& tree, const Dataset& dataset, uint32_t samples,
                    const ViewCallback& done) {
    uint32_t width = 1, height = 1;
    for (const Camera& camera : dataset.cameras) {
        width = std::max(width, camera.width);
        height = std::max(height, camera.height);
    }
    const Field field = upload_field(device, tree, WeightPrecision::kHalf);
    FrameRenderer renderer(device, field, width, height, samples);

    Evaluation result;
    result.cameras.resize(dataset.cameras.size());
    for (size_t i = 0; i < dataset.views.size(); ++i) {
        const View& view = dataset.views[i];
        const Camera& camera = dataset.cameras[view.camera];
        FrameSettings settings;
        settings.frame = static_cast<float>(frame_of_time(view.time, tree.frames));
        settings.width = camera.width;
        settings.height = camera.height;
        settings.samples = samples;
        Image render = composite_over(renderer.render(camera, settings), kWhite);
        whiten_ignored(view, render);
        const Image truth = truth_over_white(dataset, view);
        const Quality quality = compare(truth, render);
        result.views.push_back(quality);
        add(result.mean, quality);
        add(result.cameras[view.camera].quality, quality);
        ++result.cameras[view.camera].images;
        if (done && !done(i, truth, render, quality)) break;
    }
    result.mean = divided(result.mean, result.views.size());
    for (Evaluation::PerCamera& camera : result.cameras) camera.quality = divided(camera.quality, camera.images);
    return result;
}

}  // namespace neuvv
