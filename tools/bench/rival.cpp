#include "tools/bench/rivals.h"

#include <fmt/format.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "gpu/host_copies.h"
#include "tools/bench/leaf_raster.h"

namespace neuvv::bench {

namespace {

double image_ms(const RivalTimes& times) {
    double sum = 0;
    for (const PassSum& pass : times.passes) sum += median(pass.ms);
    return sum;
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

// The rays as an image over white.
media::Image image_of(const gpu::Device& device, const render::RayBatch& rays, uint32_t width, uint32_t height) {
    const gpu::Buffer pixels(device, "rival's image", uint64_t{4} * width * height, gpu::MemoryKind::kDevice,
                             VK_FORMAT_R32_UINT);
    const render::Resolver resolver(device, render::RaysPerPixel::kWhole, rays, pixels);
    render::ResolveSettings settings;
    settings.background = {1, 1, 1, 1};
    gpu::run_once(device, "resolve", [&](gpu::Commands& commands) {
        render::record_resolve(commands, resolver, {width, height}, settings);
    });
    media::Image image(width, height);
    gpu::download(device, pixels, image.rgba.data(), image.rgba.size());
    return image;
}

}  // namespace

void measure_rival(const gpu::Device& device, const render::Field& field, const render::FrameRenderer& renderer,
                   const stage::Camera& camera, const media::Image& shaded, uint32_t repeats, RivalTimes& times) {
    const render::Performer& performer = *renderer.slices().performer();
    const render::RayBatch rays = rays_of(device, camera);
    const uint32_t pairs = count_pairs(device, field, performer, rays);
    const LeafRasterizer rasterizer(device, field, performer.slices()->trees(), *performer.passes().shaded(), rays,
                                    pairs);
    gpu::Commands commands(device, "rival");
    for (uint32_t i = 0; i < repeats + 1; ++i) {
        commands.begin();
        record_leaf_raster(commands, rasterizer, 0, *rays.cameras.as<ShaderCamera>());
        commands.submit();
        commands.wait();
        if (i > 0) add_image(times.passes, commands.pass_times());  // the first one fills caches
    }
    times.pairs.push_back(pairs);
    times.differences.add(shaded, image_of(device, rays, camera.width, camera.height));
}

std::string rival_text(const RivalTimes& times, double trace_ms) {
    return fmt::format(
        "rival: sparse voxels rasterised: {} ms; {:.1f} ms together, {:.2f} times the {:.1f} ms of tile ranges and "
        "trace\n"
        "  {:.0f} pairs of a tile and a leaf; its image and the shaded one are {:.3f}/255 apart, PSNR {:.1f} dB",
        passes_text(times.passes), image_ms(times), image_ms(times) / trace_ms, trace_ms, mean(times.pairs),
        times.differences.mean_of_255(), times.differences.psnr());
}

nlohmann::ordered_json rival_json(const RivalTimes& times, double trace_ms) {
    return {{"name", "raster"},
            {"passes_ms", passes_json(times.passes)},
            {"ms", image_ms(times)},
            {"ranges_and_trace_ms", trace_ms},
            {"times_ranges_and_trace", image_ms(times) / trace_ms},
            {"pairs", mean(times.pairs)},
            {"mean_difference_of_255", times.differences.mean_of_255()},
            {"psnr_db", times.differences.psnr()}};
}

}  // namespace neuvv::bench
