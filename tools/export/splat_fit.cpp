#include "tools/export/splat_fit.h"

#include <vector>

#include "interchange/splats/fit_splats.h"
#include "interchange/splats/shown_leaves.h"
#include "slice/coarser.h"
#include "tools/compared_views.h"
#include "tools/options.h"

namespace neuvv::tools {

namespace {

constexpr size_t kCloseViews = 4;

const stage::Camera& nearest_camera(const ComparedViews& views, const glm::dvec3& place) {
    size_t nearest = 0;
    for (size_t i = 1; i < views.count(); ++i) {
        const auto away = [&](size_t view) {
            return glm::distance(glm::dvec3(views.camera_of(view).world_from_camera[3]), place);
        };
        if (away(i) < away(nearest)) nearest = i;
    }
    return views.camera_of(nearest);
}

}  // namespace

slice::Slice splat_volume(ExportedClip& clip, uint32_t frame, uint32_t most) {
    slice::Slice volume = clip.slice_of(frame);
    if (most == 0 || volume.leaves.size() <= most) return volume;
    interchange::measure_shown(volume);
    return slice::with_fewer_leaves(std::move(volume), most);
}

std::optional<FittedSplats> fit_splats(const gpu::Device& device, const ExportOptions& options,
                                       const voctree::VOctree& still, const slice::Slice& volume,
                                       const Working& working) {
    if (volume.leaves.empty()) return std::nullopt;
    const ComparedViews compared(device, still, parse_size(options.size), options.views);
    std::vector<interchange::FitView> views;
    for (size_t i = 0; i < compared.count(); ++i)
        views.push_back({compared.camera_of(i), compared.render_still(still, i)});
    // Splats are fitted where leaves are larger than pixels: a shape that was fitted to whole images relies on how
    // renderers widen small splats, and lets through what is behind it when a viewer goes nearer.
    std::vector<interchange::FitView> close;
    for (const slice::Leaf& leaf : interchange::typical_leaves(volume, kCloseViews)) {
        const stage::Camera camera =
            interchange::close_up(nearest_camera(compared, volume.centre_m(leaf)), volume, leaf);
        close.push_back({camera, compared.render_still(still, camera)});
    }
    const interchange::SplatFit fit =
        interchange::fit_shape(volume, close, [&] { working("comparing splats with images"); });
    return FittedSplats{fit.shape, interchange::psnr_of(interchange::splats_of(volume, fit.shape), views), fit.psnr};
}

}  // namespace neuvv::tools
