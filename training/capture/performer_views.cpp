#include "training/capture/performer_views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "base/error.h"
#include "base/output_path.h"
#include "base/threads/workers.h"
#include "media/image.h"
#include "render/frame/frame_renderer.h"
#include "render/volume/slices/field.h"
#include "training/capture/capture_files.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::training {

namespace {

constexpr double kElevations_deg[] = {5, 35};
constexpr glm::vec4 kGrey{0.2f, 0.2f, 0.2f, 1};  // linear; detectors were trained on rooms, not on black
constexpr uint32_t kViewSamples = 2;             // rays a pixel along each side

void check_view_settings(const ViewSettings& s) {
    if (s.views < 2 || s.views > 100)
        throw InputError(Setting{"views"}, "", fmt::format("{} is out of range", s.views), "choose 2 to 100");
    if (std::min(s.width, s.height) < 64 || std::max(s.width, s.height) > 4096)
        throw InputError(Setting{"size"}, "", fmt::format("{}x{} is out of range", s.width, s.height),
                         "choose 64 to 4096 a side");
}

std::vector<glm::vec3> corners(const std::pair<glm::dvec3, glm::dvec3>& box) {
    std::vector<glm::vec3> points;
    for (int i = 0; i < 8; ++i)
        points.emplace_back(i & 1 ? box.second.x : box.first.x, i & 2 ? box.second.y : box.first.y,
                            i & 4 ? box.second.z : box.first.z);
    return points;
}

}  // namespace

std::vector<stage::Camera> views_around(const voctree::VOctree& clip, const ViewSettings& settings) {
    std::vector<DomeCamera> ring;
    for (uint32_t i = 0; i < settings.views; ++i)
        ring.push_back(
            dome_camera(i % 2, 2 * std::numbers::pi * i / settings.views, glm::radians(kElevations_deg[i % 2])));
    const auto box = voctree::occupied_box(clip);
    DomeFit fit = dome_fit(0.5 * (box.first + box.second), settings.width, settings.height);
    include_points(fit, ring, corners(box));
    std::vector<stage::Camera> cameras;
    for (const DomeCamera& camera : ring) cameras.push_back(make_camera(camera, fit, settings.width, settings.height));
    return cameras;
}

bool render_performer_views(const gpu::Device& device, const voctree::VOctree& clip,
                            const std::filesystem::path& folder, const ViewSettings& settings,
                            const CaptureProgress& progress) {
    check_view_settings(settings);
    const std::vector<stage::Camera> cameras = views_around(clip, settings);
    prepare_output_folder(Setting{"output"}, folder / "images");

    const render::Field field = render::upload_field(device, clip, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, {settings.width, settings.height, kViewSamples});
    render::FrameSettings draw;
    draw.width = settings.width;
    draw.height = settings.height;
    draw.samples = kViewSamples;
    draw.resolve.background = kGrey;
    draw.mode = render::TraceMode::kPlay;
    const uint64_t total = uint64_t{clip.frames} * cameras.size();
    Workers workers(std::max(1u, std::thread::hardware_concurrency()), 8);
    for (uint32_t f = 0; f < clip.frames; ++f) {
        draw.instances[0].frame = static_cast<float>(f);
        for (size_t c = 0; c < cameras.size(); ++c) {
            if (progress && !progress(f * cameras.size() + c, total)) return false;
            workers.add([path = folder / "images" / (image_name(c, f) + ".png"),
                         image = renderer.render(cameras[c], draw)] { media::write_png(path, image); });
        }
    }
    workers.finish();
    write_transforms(folder / "transforms_train.json", {cameras, std::vector<bool>(cameras.size(), true), clip.frames,
                                                        clip.fps > 0 ? clip.fps : 25, voctree::occupied_box(clip)});
    return !progress || progress(total, total);
}

}  // namespace neuvv::training
