#include "tools/bench/rival.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tools/bench/leaf_raster.h"
#include "tools/bench/measure.h"
#include "training/metrics.h"

namespace neuvv::bench {

namespace {

double psnr(const RivalTimes& times) {
    return -10 * std::log10(std::max(mean(times.squares), 1e-10));
}

double image_ms(const RivalTimes& times) {
    return median(times.project_ms) + median(times.sort_ms) + median(times.composite_ms);
}

render::RayBatch rays_of(const gpu::Device& device, const stage::Camera& camera) {
    const std::vector<Tile> tiles = render::tiles_of_image(0, camera.width, camera.height);
    render::RayBatch rays(device, 1, static_cast<uint32_t>(tiles.size()));
    *rays.cameras.as<ShaderCamera>() = render::shader_camera(camera);
    std::memcpy(rays.tiles.mapped, tiles.data(), tiles.size() * sizeof(Tile));
    return rays;
}

uint32_t count_pairs(const gpu::Device& device, const render::Field& field, const render::Performer& performer,
                     const render::RayBatch& rays) {
    const LeafRasterizer counter(device, field, performer.slices()->trees(), *performer.passes().shaded(), rays, 1);
    gpu::run_once(device, "count pairs", [&](gpu::Commands& commands) {
        record_leaf_raster(commands, counter, 0, *rays.cameras.as<ShaderCamera>());
    });
    return pair_count(device, counter);
}

void add_times(RivalTimes& times, const std::vector<gpu::PassTime>& passes) {
    for (const gpu::PassTime& pass : passes) {
        if (pass.name == "project") times.project_ms.push_back(pass.milliseconds);
        if (pass.name == "sort") times.sort_ms.push_back(pass.milliseconds);
        if (pass.name == "composite") times.composite_ms.push_back(pass.milliseconds);
    }
}

// The rays as an image over white.
media::Image image_of(const gpu::Device& device, const render::RayBatch& rays, uint32_t width, uint32_t height) {
    const gpu::Buffer image(device, "rival's image", uint64_t{4} * width * height, gpu::MemoryKind::kDevice,
                            VK_FORMAT_R32_UINT);
    const render::Resolver resolver(device, render::RaysPerPixel::kWhole, rays, image);
    render::ResolveSettings settings;
    settings.background = {1, 1, 1, 1};
    gpu::run_once(device, "resolve", [&](gpu::Commands& commands) {
        render::record_resolve(commands, resolver, {width, height}, settings);
    });
    media::Image image(width, height);
    gpu::download(device, image, image.rgba.data(), image.rgba.size());
    return image;
}

}  // namespace

void measure_rival(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                   const stage::Camera& camera, const media::Image& shaded, uint32_t repeats, RivalTimes& times) {
    const render::Performer& performer = *renderer.performer();
    const render::RayBatch rays = rays_of(device, camera);
    const uint32_t pairs = count_pairs(device, field, performer, rays);
    const LeafRasterizer rasterizer(device, field, performer.slices()->trees(), *performer.passes().shaded(), rays,
                                    pairs);
    gpu::Commands commands(device, "rival");
    for (uint32_t i = 0; i < repeats + 1; i++) {
        commands.begin();
        record_leaf_raster(commands, rasterizer, 0, *rays.cameras.as<ShaderCamera>());
        commands.submit();
        commands.wait();
        if (i > 0) add_times(times, commands.pass_times());  // the first warms caches
    }
    const training::Quality quality = training::compare(shaded, image_of(device, rays, camera.width, camera.height));
    times.pairs.push_back(pairs);
    times.differences.push_back(quality.mae);
    times.squares.push_back(std::pow(10, -quality.psnr / 10));
}

std::string rival_text(const RivalTimes& times, double trace_ms) {
    return fmt::format(
        "rival: sparse voxels rasterised: project {:.1f} sort {:.1f} composite {:.1f} ms; {:.1f} ms together, {:.2f} "
        "times the {:.1f} ms of tile ranges and trace\n"
        "  {:.0f} pairs of a tile and a leaf; its image and the shaded one are {:.3f}/255 apart, PSNR {:.1f} dB",
        median(times.project_ms), median(times.sort_ms), median(times.composite_ms), image_ms(times),
        image_ms(times) / trace_ms, trace_ms, mean(times.pairs), 255 * mean(times.differences), psnr(times));
}

nlohmann::ordered_json rival_json(const RivalTimes& times, double trace_ms) {
    return {{"name", "raster"},
            {"passes_ms",
             {{"project", median(times.project_ms)},
              {"sort", median(times.sort_ms)},
              {"composite", median(times.composite_ms)}}},
            {"ms", image_ms(times)},
            {"ranges_and_trace_ms", trace_ms},
            {"times_ranges_and_trace", image_ms(times) / trace_ms},
            {"pairs", mean(times.pairs)},
            {"mean_difference_of_255", 255 * mean(times.differences)},
            {"psnr_db", psnr(times)}};
}

}  // namespace neuvv::bench
