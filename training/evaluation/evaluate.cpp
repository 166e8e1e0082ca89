#include "training/evaluation/evaluate.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "media/psnr.h"
#include "render/clips/shown_segments.h"
#include "render/clips/uploaded_segment.h"
#include "render/frame/frame_renderer.h"
#include "training/data/layouts/rig/camera_names.h"
#include "voctree/files/clip.h"

namespace neuvv::training {

namespace {

void add(Quality& sum, const Quality& quality) {
    sum.psnr += quality.psnr;
    sum.ssim += quality.ssim;
    sum.mae += quality.mae;
    sum.flip += quality.flip;
}

Quality divided(const Quality& sum, size_t count) {
    const double n = std::max(1.0, static_cast<double>(count));
    return {sum.psnr / n, sum.ssim / n, sum.mae / n, sum.flip / n};
}

void add(Evaluation::Group& group, const Quality& quality) {
    add(group.quality, quality);
    ++group.images;
}

void divide(std::vector<Evaluation::Group>& groups) {
    for (Evaluation::Group& group : groups) group.quality = divided(group.quality, group.images);
}

// Ignored pixels show the background in both images, as nothing is known about them.
void clear_ignored(const View& view, media::Image& image, const uint8_t background[3]) {
    for (uint32_t y = 0; y < image.height && !view.ignored.empty(); ++y)
        for (uint32_t x = 0; x < image.width; ++x)
            if (view.ignores(x, y)) std::copy(background, background + 3, image.at(x, y));
}

// Compares views with renders, and sums what it finds.
class Comparison {
  public:
    Comparison(const Dataset& dataset, const CompareSettings& settings, const ViewCallback& done)
        : dataset_(dataset), settings_(settings), done_(done) {
        for (const stage::Camera& camera : dataset.cameras) {
            capacity_.width = std::max(capacity_.width, camera.width);
            capacity_.height = std::max(capacity_.height, camera.height);
        }
        capacity_.samples = settings.samples;
        sums_.cameras.resize(dataset.cameras.size());
        sums_.frames.resize(dataset.times.size());
        sums_.views.resize(dataset.views.size());
    }

    // What a renderer needs for the largest view.
    const render::FrameCapacity& capacity() const { return capacity_; }

    // False where the callback ended it.
    bool add(size_t index, render::FrameRenderer& renderer, std::vector<render::Instance> instances) {
        const View& view = dataset_.views[index];
        const media::Image render = render_over(renderer, dataset_.cameras[view.camera], view, std::move(instances),
                                                settings_.samples, settings_.background);
        const media::Image truth = truth_over(dataset_, view, settings_.background);
        const Quality quality = compare_part(truth, render, view, settings_.part);
        sums_.views[index] = quality;
        ++sums_.compared;
        training::add(sums_.mean, quality);
        training::add(sums_.cameras[view.camera], quality);
        training::add(sums_.frames[frame_of_view(dataset_, view)], quality);
        return !done_ || done_(index, truth, render, quality);
    }

    Evaluation result() const {
        Evaluation means = sums_;
        means.mean = divided(means.mean, means.compared);
        divide(means.cameras);
        divide(means.frames);
        return means;
    }

  private:
    const Dataset& dataset_;
    const CompareSettings settings_;
    const ViewCallback& done_;
    render::FrameCapacity capacity_{1, 1};
    Evaluation sums_;
};

}  // namespace

std::vector<std::vector<ViewFrame>> views_by_segment(const voctree::ClipIndex& clip, const Dataset& dataset) {
    std::vector<std::vector<ViewFrame>> views(clip.segments.size());
    for (size_t i = 0; i < dataset.views.size(); ++i) {
        const auto [segment, frame] = voctree::segment_frame(clip, frame_of_time(dataset.views[i].time, clip.frames()));
        views[segment].push_back({i, frame});
    }
    return views;
}

size_t frame_of_view(const Dataset& dataset, const View& view) {
    return static_cast<size_t>(std::lower_bound(dataset.times.begin(), dataset.times.end(), view.time) -
                               dataset.times.begin());
}

std::vector<std::string> camera_labels(const Dataset& dataset) {
    if (dataset.camera_names.size() == dataset.cameras.size()) return dataset.camera_names;
    std::vector<std::vector<std::string>> images(dataset.cameras.size());
    for (const View& view : dataset.views) images[view.camera].push_back(view.name);
    if (auto names = names_by_images(images)) return *names;
    std::vector<std::string> numbers;
    for (size_t i = 0; i < images.size(); ++i) numbers.push_back(std::to_string(i));
    return numbers;
}

std::vector<size_t> spread_views(const Dataset& dataset, size_t count) {
    std::vector<std::vector<size_t>> by_camera(dataset.cameras.size());
    for (size_t i = 0; i < dataset.views.size(); ++i) by_camera[dataset.views[i].camera].push_back(i);
    std::erase_if(by_camera, [](const auto& views) { return views.empty(); });
    count = std::min(count, dataset.views.size());
    if (count == dataset.views.size()) {
        std::vector<size_t> all(count);
        std::iota(all.begin(), all.end(), size_t{0});
        return all;
    }
    std::set<size_t> selected;
    const size_t cameras = by_camera.size(), turns = std::max(cameras, count);
    // Times follow multiples of the golden ratio, which are spread evenly however many there are.
    for (size_t i = 0; i < count; ++i) {
        const std::vector<size_t>& views = by_camera[i * turns / count % cameras];
        const double fraction = std::fmod(static_cast<double>(i) * 0.6180339887, 1.0);
        selected.insert(views[static_cast<size_t>(fraction * static_cast<double>(views.size()))]);
    }
    return {selected.begin(), selected.end()};
}

media::Image compared_part(const media::Image& image, const View& view, ComparedPart part, uint32_t least_side) {
    uint32_t left = image.width, top = image.height, right = 0, bottom = 0;
    for (uint32_t y = 0; y < image.height && part != ComparedPart::kImage; ++y)
        for (uint32_t x = 0; x < image.width; ++x) {
            if (view.image.at(x, y)[3] == 0) continue;
            left = std::min(left, x);
            right = std::max(right, x + 1);
            top = std::min(top, y);
            bottom = y + 1;
        }
    if (right == 0) return image;
    const auto widen = [&](uint32_t& low, uint32_t& high, uint32_t size) {
        const uint32_t side = std::min(std::max(high - low, least_side), size);
        low = std::min(low, size - side);
        high = low + side;
    };
    widen(left, right, image.width);
    widen(top, bottom, image.height);
    media::Image result(right - left, bottom - top);
    for (uint32_t y = top; y < bottom; ++y)
        std::copy_n(image.at(left, y), size_t{4} * result.width, result.at(0, y - top));
    return result;
}

Quality compare_part(const media::Image& truth, const media::Image& render, const View& view, ComparedPart part) {
    Quality quality = compare(compared_part(truth, view, part), compared_part(render, view, part));
    if (part != ComparedPart::kMatte) return quality;
    uint32_t count = 0;
    view.image.for_each_kept([&](uint32_t, uint32_t, const uint8_t* pixel) { count += pixel[3] > 0; });
    if (count == 0) return quality;
    media::Image of_truth(count, 1), of_render(count, 1);  // the matte's pixels side by side
    uint32_t next = 0;
    view.image.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* pixel) {
        if (pixel[3] == 0) return;
        std::copy_n(truth.at(x, y), 4, of_truth.at(next, 0));
        std::copy_n(render.at(x, y), 4, of_render.at(next++, 0));
    });
    quality.psnr = media::psnr_db(of_truth, of_render);
    return quality;
}

media::Image render_over(render::FrameRenderer& renderer, const stage::Camera& camera, const View& view,
                         std::vector<render::Instance> instances, uint32_t samples, const uint8_t background[3]) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = camera.width;
    settings.height = camera.height;
    settings.samples = samples;
    settings.mode = render::TraceMode::kTree;
    media::Image render = media::composite_over(renderer.render(camera, settings), background);
    clear_ignored(view, render, background);
    return render;
}

Evaluation evaluate(const gpu::Device& device, const voctree::VOctree& tree, const Dataset& dataset,
                    const CompareSettings& settings, const ViewCallback& done) {
    Comparison comparison(dataset, settings, done);
    const render::Field field = render::upload_field(device, tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device, field, comparison.capacity());
    for (size_t i = 0; i < dataset.views.size(); ++i) {
        const auto frame = static_cast<float>(frame_of_time(dataset.views[i].time, tree.frames));
        if (!comparison.add(i, renderer, {{frame}})) break;
    }
    return comparison.result();
}

Evaluation evaluate(const gpu::Device& device, const voctree::ClipIndex& clip, const Dataset& dataset,
                    const CompareSettings& settings, const ViewCallback& done) {
    Comparison comparison(dataset, settings, done);
    render::ShownSegments shown(clip, [&](const voctree::ClipSegment& segment, uint32_t) {
        return render::upload_segment(device, segment, render::FarLevels::kNo).field;
    });
    std::optional<render::FrameRenderer> renderer;
    const auto use = [&](const std::vector<const render::Field*>& fields) {
        if (renderer) return renderer->change_fields(fields);
        renderer.emplace(device, fields, comparison.capacity());
    };
    for (const std::vector<ViewFrame>& views : views_by_segment(clip, dataset))
        for (const ViewFrame& one : views) {
            const double frame = frame_of_time(dataset.views[one.view].time, clip.frames());
            std::vector<render::Instance> instances = shown.show(voctree::segment_shares(clip, frame), use);
            if (!comparison.add(one.view, *renderer, std::move(instances))) return comparison.result();
        }
    return comparison.result();
}

}  // namespace neuvv::training
