#include "render/frame/frame_passes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "gpu/host_copies.h"
#include "shared/colour_map.h"
#include "shared/lights.h"
#include "voctree/files/half.h"

namespace neuvv::render {

namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

float finite_or_nothing(float value) {
    return std::isfinite(value) ? value : kNothing;
}

// Luminance of linear light (ITU-R BT.709).
float luminance(glm::vec4 light) {
    return 0.2126f * light.r + 0.7152f * light.g + 0.0722f * light.b;
}

template <typename T>
std::vector<T> first_of(const gpu::Device& device, const gpu::Buffer& buffer, size_t count) {
    std::vector<T> values(count);
    gpu::download(device, buffer, values.data(), count * sizeof(T));
    return values;
}

// Buffers with a number per ray.

PassValues of_rays(const FrameRenderer& renderer, std::vector<float> values) {
    return {renderer.plan().layout.rays_across(), renderer.plan().layout.rays_down(), std::move(values)};
}

PassValues read_radiance(const FrameRenderer& renderer) {
    std::vector<float> values;
    for (const glm::vec4 light : renderer.radiance()) values.push_back(luminance(light));
    return of_rays(renderer, std::move(values));
}

PassValues read_alpha(const FrameRenderer& renderer) {
    std::vector<float> values;
    for (const glm::vec4 light : renderer.radiance()) values.push_back(light.a);
    return of_rays(renderer, std::move(values));
}

PassValues read_depth(const FrameRenderer& renderer) {
    std::vector<float> values = renderer.depth();
    for (float& value : values) value = finite_or_nothing(value);
    return of_rays(renderer, std::move(values));
}

// Buffers with a number per tile of 8×8 rays.

PassValues of_tiles(const FrameRenderer& renderer) {
    const uint32_t width = renderer.plan().layout.tiles_across(), height = renderer.plan().layout.tiles_down();
    return {width, height, std::vector<float>(size_t{width} * height, kNothing)};
}

enum class Bound { kNear, kFar };

template <Bound bound>
PassValues read_tile_range(const FrameRenderer& renderer) {
    PassValues tiles = of_tiles(renderer);
    if (renderer.plan().drawn.empty()) return tiles;
    const auto ranges = first_of<glm::uvec2>(renderer.device(), renderer.target().ranges.ranges, tiles.values.size());
    for (size_t tile = 0; tile < ranges.size(); ++tile)
        if (ranges[tile].x != kNoTile)
            tiles.values[tile] = std::bit_cast<float>(bound == Bound::kNear ? ranges[tile].x : ~ranges[tile].y);
    return tiles;
}

PassValues read_tile_list(const FrameRenderer& renderer) {
    PassValues tiles = of_tiles(renderer);
    if (renderer.plan().drawn.empty()) return tiles;
    const auto list =
        first_of<uint32_t>(renderer.device(), renderer.target().ranges.list, renderer.plan().layout.ray_tiles());
    for (size_t i = 0; i < list.size(); ++i)
        if (list[i] < tiles.values.size()) tiles.values[list[i]] = static_cast<float>(i);
    return tiles;
}

PassValues read_covered_tiles(const FrameRenderer& renderer) {
    PassValues tiles = of_tiles(renderer);
    const auto covered = first_of<uint32_t>(renderer.device(), renderer.target().ranges.covered, tiles.values.size());
    std::transform(covered.begin(), covered.end(), tiles.values.begin(),
                   [](uint32_t any) { return any ? 1.0f : 0.0f; });
    return tiles;
}

// Buffers with a number per texel of the set's image.

PassValues of_texels(const FrameRenderer& renderer) {
    const ViewLayout& layout = renderer.plan().layout;
    const uint32_t width = layout.samples * layout.width, height = layout.samples * layout.height;
    return {width, height, std::vector<float>(size_t{width} * height, kNothing)};
}

template <gpu::Buffer SetTargets::*buffer>
PassValues read_set_light(const FrameRenderer& renderer) {
    PassValues texels = of_texels(renderer);
    const auto halves =
        first_of<glm::u16vec4>(renderer.device(), renderer.set()->targets().*buffer, texels.values.size());
    for (size_t i = 0; i < halves.size(); ++i) {
        const auto channel = [&](int c) { return voctree::float_from_half(halves[i][c]); };
        if (channel(3) > 0) texels.values[i] = luminance({channel(0), channel(1), channel(2), channel(3)});
    }
    return texels;
}

template <gpu::Buffer SetTargets::*buffer>
PassValues read_set_metres(const FrameRenderer& renderer) {
    PassValues texels = of_texels(renderer);
    texels.values = first_of<float>(renderer.device(), renderer.set()->targets().*buffer, texels.values.size());
    for (float& value : texels.values) value = finite_or_nothing(value);
    return texels;
}

// Shadow maps, side by side in the order of their lights.

std::vector<uint32_t> shadow_maps(const SetLighting& lighting) {
    std::vector<uint32_t> maps;
    for (uint32_t i = 0; i < lighting.lights().count; ++i)
        if (lighting.lights().light[i].shadow != kNoShadow) maps.push_back(lighting.lights().light[i].shadow);
    return maps;
}

// Maps side by side, where value(i) is the number of texel i of the buffer of all maps. One map without numbers where
// no light casts a shadow.
template <typename Value>
PassValues beside_each_other(const std::vector<uint32_t>& maps, uint32_t side, const Value& value) {
    PassValues texels{side * std::max(static_cast<uint32_t>(maps.size()), 1u), side, {}};
    texels.values.assign(size_t{texels.width} * side, kNothing);
    for (uint32_t m = 0; m < maps.size(); ++m)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                texels.values[size_t{y} * texels.width + m * side + x] = value((size_t{maps[m]} * side + y) * side + x);
    return texels;
}

PassValues read_set_shadow(const FrameRenderer& renderer) {
    const SetLighting& lighting = renderer.set()->lighting;
    const auto depths = first_of<float>(renderer.device(), lighting.set_shadow_maps,
                                        size_t{kMaxShadows} * kSetShadowSide * kSetShadowSide);
    const std::vector<uint32_t> maps = lighting.lights().set_shadows ? shadow_maps(lighting) : std::vector<uint32_t>();
    return beside_each_other(maps, kSetShadowSide, [&](size_t i) { return depths[i] > 0 ? depths[i] : kNothing; });
}

enum class Shadow { kAlpha, kDepth };

template <Shadow what>
PassValues read_performer_shadow(const FrameRenderer& renderer) {
    const SetLighting& lighting = renderer.set()->lighting;
    const auto shadows = first_of<glm::vec2>(renderer.device(), lighting.performer_shadows,
                                             size_t{kMaxShadows} * kPerformerShadowSide * kPerformerShadowSide);
    const std::vector<uint32_t> maps =
        lighting.lights().performer_shadows ? shadow_maps(lighting) : std::vector<uint32_t>();
    return beside_each_other(maps, kPerformerShadowSide, [&](size_t i) {
        if (what == Shadow::kAlpha) return shadows[i].x;
        return shadows[i].x > 0 ? shadows[i].y : kNothing;
    });
}

constexpr std::array kPasses = {
    FramePass{"performer-shadow-alpha", "Performers as the lights with shadows see them, low-passed: alpha", "share",
              true, read_performer_shadow<Shadow::kAlpha>},
    FramePass{"performer-shadow-depth", "The same: distance from the light's eye", "m", true,
              read_performer_shadow<Shadow::kDepth>},
    FramePass{"set-shadow", "The set as the lights with shadows see it: reversed depth, 1 next to the light", "0 to 1",
              true, read_set_shadow},
    FramePass{"set-light", "Light of the opaque set and of what is blended behind performers, a texel",
              "linear, 1: white", true, read_set_light<&SetTargets::colour>},
    FramePass{"set-depth", "Distance of the opaque set along the camera's axis, a texel", "m", true,
              read_set_metres<&SetTargets::depth>},
    FramePass{"tile-near", "Least distance at which rays may meet the last instance, a tile of 8x8 rays", "m", false,
              read_tile_range<Bound::kNear>},
    FramePass{"tile-far", "Largest distance at which they may meet it", "m", false, read_tile_range<Bound::kFar>},
    FramePass{"tile-list", "Where a tile stands in the list of those that are traced for the last instance", "index",
              false, read_tile_list},
    FramePass{"tiles-seen", "Tiles in which any instance may be seen", "0 or 1", false, read_covered_tiles},
    FramePass{"radiance", "Premultiplied light of performers (luminance), a ray", "linear, 1: white", false,
              read_radiance},
    FramePass{"alpha", "Alpha of performers, a ray", "share", false, read_alpha},
    FramePass{"depth", "Distance along the ray at which performers are seen", "m", false, read_depth},
    FramePass{"volume-depth", "Distance of performers along the camera's axis, where a set has blended pieces, a texel",
              "m", true, read_set_metres<&SetTargets::volume_depth>},
    FramePass{"set-front", "Light of what is blended before performers, a texel", "linear, 1: white", true,
              read_set_light<&SetTargets::front>},
};

glm::vec3 viridis(float at) {
    const glm::vec4 terms[] = {kViridis0, kViridis1, kViridis2, kViridis3, kViridis4, kViridis5, kViridis6};
    glm::vec4 sum(0);
    for (int i = 6; i >= 0; --i) sum = terms[i] + at * sum;
    return glm::clamp(glm::vec3(sum), 0.0f, 1.0f);
}

}  // namespace

std::span<const FramePass> frame_passes() {
    return kPasses;
}

const FramePass* find_frame_pass(std::string_view name) {
    const auto found =
        std::find_if(kPasses.begin(), kPasses.end(), [&](const FramePass& pass) { return pass.name == name; });
    return found == kPasses.end() ? nullptr : &*found;
}

std::optional<std::pair<float, float>> range_of(const PassValues& values) {
    std::optional<std::pair<float, float>> range;
    for (const float value : values.values) {
        if (std::isnan(value)) continue;
        if (!range) range = {value, value};
        range = {std::min(range->first, value), std::max(range->second, value)};
    }
    return range;
}

media::Image colour_mapped(const PassValues& values, std::pair<float, float> range) {
    media::Image image(values.width, values.height);
    const float span = range.second > range.first ? range.second - range.first : 1;
    for (size_t i = 0; i < values.values.size(); ++i) {
        uint8_t* pixel = &image.rgba[4 * i];
        if (std::isnan(values.values[i])) {
            std::fill_n(pixel, 4, uint8_t{0});
            continue;
        }
        const glm::vec3 colour = viridis(std::clamp((values.values[i] - range.first) / span, 0.0f, 1.0f));
        for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uint8_t>(std::lround(255 * colour[c]));
        pixel[3] = 255;
    }
    return image;
}

}  // namespace neuvv::render
