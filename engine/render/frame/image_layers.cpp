#include "render/frame/image_layers.h"

#include <algorithm>
#include <cmath>

#include "base/threads/parallel.h"
#include "render/rays/linear_image.h"
#include "shared/trace.h"

namespace neuvv::render {

namespace {

// A performer may have any name, and Cryptomatte knows a thing by its name alone.
std::string name_of_set(std::span<const std::string> performers) {
    std::string name = kSetName;
    while (std::find(performers.begin(), performers.end(), name) != performers.end()) name += "_";
    return name;
}

}  // namespace

ImageLayers::ImageLayers(const stage::Camera& camera, uint32_t samples, std::span<const std::string> names,
                         const SetRays& set, Wanted wanted, float stop)
    : camera_(camera),
      rays_(stage::enlarged(camera, samples)),
      samples_(samples),
      set_(set),
      wanted_(wanted),
      stop_(stop) {
    std::vector<std::string> all(names.begin(), names.end());
    if (!set.axis_m.empty()) all.push_back(name_of_set(names));
    for (const std::string& name : all) {
        const auto known = std::find(ids.names.begin(), ids.names.end(), name);
        name_of_.push_back(static_cast<uint32_t>(known - ids.names.begin()));
        if (known == ids.names.end()) ids.names.push_back(name);
    }
    deep.width = camera.width;
    deep.height = camera.height;
}

void ImageLayers::add(glm::uvec2 ray, std::span<const RayInterval> intervals) {
    finish_rows(ray.y / kTile * kTile / samples_);
    RowOfRays& row = rows_[ray.y / samples_];
    row.resize(size_t{samples_} * rays_.width);
    const size_t of_pixel = ray.y % samples_ * samples_ + ray.x % samples_;
    row[size_t{ray.x / samples_} * samples_ * samples_ + of_pixel].assign(intervals.begin(), intervals.end());
}

void ImageLayers::finish_rows(uint32_t end) {
    constexpr size_t kGrain = 16;
    const size_t of_pixel = size_t{samples_} * samples_;
    for (; next_row_ < end; ++next_row_) {
        RowOfRays row = std::move(rows_[next_row_]);
        rows_.erase(next_row_);
        row.resize(of_pixel * camera_.width);
        std::vector<Pixel> pixels(camera_.width);
        parallel_for(pixels.size(), kGrain, [&](size_t first, size_t last) {
            for (size_t x = first; x < last; ++x)
                pixels[x] =
                    pixel_of({static_cast<uint32_t>(x), next_row_}, std::span(row).subspan(of_pixel * x, of_pixel));
        });
        for (const Pixel& pixel : pixels) {
            if (wanted_.ids) ids.pixels.push_back(pixel.ranks);
            if (!wanted_.deep) continue;
            deep.counts.push_back(static_cast<uint32_t>(pixel.samples.size()));
            deep.samples.insert(deep.samples.end(), pixel.samples.begin(), pixel.samples.end());
        }
    }
}

// The set ends the ray. What is blended before performers takes its part of what they show.
void ImageLayers::add_set(MergedRay& ray, size_t index) const {
    const auto set = static_cast<uint32_t>(name_of_.size()) - 1;
    const glm::vec4 &behind = set_.behind[index], &front = set_.front[index];
    const float through = ray.stretches.empty() ? 1 : ray.stretches.back().after, metres = set_.axis_m[index];
    if (!std::isinf(metres) && behind.a > 0) {
        ray.seen.push_back({set, through * behind.a});
        ray.stretches.push_back({metres, metres, through, through * (1 - behind.a), through * glm::vec3(behind)});
    }
    if (!(front.a > 0)) return;
    for (SeenPerformer& seen : ray.seen) seen.share *= 1 - front.a;
    ray.seen.push_back({set, front.a});
}

ImageLayers::Pixel ImageLayers::pixel_of(glm::uvec2 at, std::span<const std::vector<RayInterval>> rays) const {
    std::vector<std::vector<RayStretch>> stretches;
    std::vector<media::IdRank> ranks;
    for (uint32_t i = 0; i < rays.size(); ++i) {
        const glm::uvec2 ray = samples_ * at + glm::uvec2(i % samples_, i / samples_);
        MergedRay merged = merge_intervals(rays[i], stop_);
        const float to_axis = axis_per_ray(rays_, ray);
        for (RayStretch& stretch : merged.stretches) {
            stretch.near_m *= to_axis;
            stretch.far_m *= to_axis;
        }
        if (!set_.axis_m.empty()) add_set(merged, size_t{ray.y} * rays_.width + ray.x);
        for (const SeenPerformer& seen : merged.seen) {
            const uint32_t name = name_of_.at(seen.performer);
            auto rank = std::find_if(ranks.begin(), ranks.end(), [&](const auto& one) { return one.name == name; });
            if (rank == ranks.end()) rank = ranks.insert(rank, {name, 0});
            rank->coverage += seen.share / static_cast<float>(rays.size());
        }
        stretches.push_back(std::move(merged.stretches));
    }
    std::stable_sort(ranks.begin(), ranks.end(), [](const auto& a, const auto& b) { return a.coverage > b.coverage; });
    ranks.resize(media::kIdRanks);
    Pixel pixel;
    std::copy(ranks.begin(), ranks.end(), pixel.ranks.begin());
    if (wanted_.deep) pixel.samples = deep_samples(stretches);
    return pixel;
}

}  // namespace neuvv::render
