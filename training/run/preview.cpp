#include "training/run/preview.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "render/frame/frame_renderer.h"
#include "training/evaluation/evaluate.h"

namespace neuvv::training {

namespace {

constexpr uint32_t kSamples = 2;  // rays along each side of a pixel

media::Image side_by_side(const std::vector<media::Image>& images) {
    media::Image row(images[0].width * static_cast<uint32_t>(images.size()), images[0].height);
    for (uint32_t i = 0; i < images.size(); ++i)
        for (uint32_t y = 0; y < row.height; ++y)
            std::copy_n(images[i].at(0, y), size_t{4} * images[i].width, row.at(i * images[i].width, y));
    return row;
}

}  // namespace

Dataset preview_dataset(const Dataset& dataset) {
    assert(!dataset.views.empty() && "a data set has images");
    const View* selected = &dataset.views[0];
    for (const View& view : dataset.views)
        if (view.camera == selected->camera && std::abs(view.time - 0.5) < std::abs(selected->time - 0.5))
            selected = &view;
    Dataset cut;
    cut.folder = dataset.folder;
    cut.cameras = {dataset.cameras[selected->camera]};
    cut.plates = {dataset.plates[selected->camera]};
    cut.views = {*selected};
    cut.views[0].camera = 0;
    cut.times = {selected->time};
    return cut;
}

Quality write_preview(const gpu::Device& device, const render::Field& field, const Dataset& dataset,
                      const std::filesystem::path& file) {
    const View& view = dataset.views[0];
    const media::Image truth = truth_over(dataset, view);
    render::FrameRenderer renderer(device, field, {truth.width, truth.height, kSamples});
    const auto frame = static_cast<float>(frame_of_time(view.time, field.frames));
    const media::Image render = render_over(renderer, dataset.cameras[view.camera], view, {{frame}}, kSamples);
    media::write_png(file, side_by_side({truth, render, error_image(truth, render)}));
    return compare(truth, render);
}

}  // namespace neuvv::training
