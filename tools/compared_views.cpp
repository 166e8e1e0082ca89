#include "tools/compared_views.h"

#include <algorithm>
#include <cmath>

#include "media/psnr.h"
#include "render/frame/frame_renderer.h"
#include "render/rays/linear_image.h"
#include "tools/commands.h"

namespace neuvv::tools {

namespace {

render::FrameSettings compared_settings(media::ImageSize size) {
    render::FrameSettings settings;
    settings.width = size.width;
    settings.height = size.height;
    settings.samples = kDefaultSamples;
    return settings;
}

}  // namespace

ComparedViews::ComparedViews(const gpu::Device& device, const voctree::VOctree& tree, media::ImageSize size,
                             uint32_t count)
    : device_(device), size_(size) {
    const std::vector<ViewStep> path = orbit_path(tree, size_);
    for (size_t i = 0; i < count; ++i) views_.push_back(path[(2 * i + 1) * path.size() / (size_t{2} * count)]);
}

void ComparedViews::round_frames() {
    for (ViewStep& view : views_) view.frame = std::floor(view.frame);
}

std::vector<media::Image> ComparedViews::render(const voctree::VOctree& tree, std::span<const voctree::PaintStep> paint,
                                                const std::vector<ViewStep>& views, const glm::vec3& background) const {
    const render::Field field = render::upload_field(device_, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device_, field, {size_.width, size_.height, kDefaultSamples});
    render::FrameSettings settings = compared_settings(size_);
    settings.resolve.background = {background.r, background.g, background.b, 1};
    std::vector<render::PaintUse> uses;
    for (const voctree::PaintStep& step : paint)
        uses.push_back({step.layer, static_cast<stage::PaintBlend>(step.blend), step.opacity});
    if (!uses.empty()) settings.instances[0].paint = renderer.paints().add(uses);
    std::vector<media::Image> images;
    for (const ViewStep& view : views) {
        settings.instances[0].frame = static_cast<float>(view.frame);
        images.push_back(renderer.render(view.camera, settings));
    }
    return images;
}

std::vector<media::Image> ComparedViews::render(const voctree::VOctree& tree,
                                                std::span<const voctree::PaintStep> paint) const {
    return render(tree, paint, views_, glm::vec3(1));
}

media::Image ComparedViews::render_still(const voctree::VOctree& tree, const stage::Camera& camera) const {
    return render(tree, {}, {{camera, 0}}, glm::vec3(1))[0];
}

media::LinearImage ComparedViews::light_of_still(const voctree::VOctree& tree, size_t i) const {
    const render::Field field = render::upload_field(device_, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device_, field, {size_.width, size_.height, kDefaultSamples});
    renderer.render(views_[i].camera, compared_settings(size_));
    return render::linear_image(renderer.radiance(), renderer.depth(), views_[i].camera, kDefaultSamples);
}

bool shows_something(const media::Image& image, const glm::vec3& background) {
    constexpr int kLeastDifference = 8;
    size_t shown = 0;
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        for (size_t c = 0; c < 3; ++c)
            if (std::abs(image.rgba[i + c] - static_cast<int>(255 * background[static_cast<int>(c)])) >=
                kLeastDifference) {
                ++shown;
                break;
            }
    return 1000 * shown >= image.rgba.size() / 4 && shown > 0;
}

double psnr_together(std::span<const double> psnrs) {
    double error = 0;
    for (const double psnr : psnrs) error += std::pow(10, -psnr / 10) / static_cast<double>(psnrs.size());
    return -10 * std::log10(error);
}

double worst_psnr(const std::vector<media::Image>& truth, const std::vector<media::Image>& images) {
    double worst = 99;
    for (size_t i = 0; i < truth.size(); ++i) worst = std::min(worst, media::psnr_db(truth[i], images[i]));
    return worst;
}

}  // namespace neuvv::tools
