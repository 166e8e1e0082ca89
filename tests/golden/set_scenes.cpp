#include "golden/set_scenes.h"

#include <cmath>

#include "gpu/host_copies.h"
#include "render/set/raster.h"
#include "support/look_at.h"
#include "support/set_scene.h"

namespace neuvv::test {

namespace {

constexpr uint32_t kSetSize = 160, kTexels = 2;  // pixels, and texels per pixel along each axis

// Tiles of 8 pixels in two colours.
media::Image checks(glm::u8vec3 a, glm::u8vec3 b) {
    media::Image image(64, 64);
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 64; ++x) {
            const glm::u8vec3 colour = (x / 8 + y / 8) % 2 ? a : b;
            for (int c = 0; c < 3; ++c) image.at(x, y)[c] = colour[c];
            image.at(x, y)[3] = 255;
        }
    return image;
}

// A normal map of round studs.
media::Image studs() {
    media::Image image(64, 64);
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 64; ++x) {
            const glm::dvec2 from_centre((x % 16 - 7.5) / 6, -(y % 16 - 7.5) / 6);
            const double square = glm::dot(from_centre, from_centre);
            const glm::dvec3 n = square < 1 ? glm::normalize(glm::dvec3(from_centre, 1.2)) : glm::dvec3(0, 0, 1);
            for (int c = 0; c < 3; ++c) image.at(x, y)[c] = static_cast<uint8_t>(std::lround(127.5 * (n[c] + 1)));
            image.at(x, y)[3] = 255;
        }
    return image;
}

// An environment image: a sky that brightens upwards, with a warm window to the right, over dark ground.
media::Image sky() {
    media::Image image(128, 64);
    for (uint32_t y = 0; y < 64; ++y)
        for (uint32_t x = 0; x < 128; ++x) {
            const double up = 1 - y / 32.0;
            glm::dvec3 light = up > 0 ? glm::mix(glm::dvec3(0.3, 0.35, 0.4), glm::dvec3(0.08, 0.16, 0.4), up)
                                      : glm::dvec3(0.06, 0.05, 0.05);
            if (x > 88 && x < 104 && y > 12 && y < 28) light = {1, 0.8, 0.5};
            for (int c = 0; c < 3; ++c) image.at(x, y)[c] = media::srgb_byte_from_linear(static_cast<float>(light[c]));
            image.at(x, y)[3] = 255;
        }
    return image;
}

void add_floor(GlbBuilder& glb) {
    json material = pbr_material(glm::vec4(1), 0, 0.5);
    material["pbrMetallicRoughness"]["baseColorTexture"] = {
        {"index", add_texture(glb, checks({180, 170, 150}, {90, 95, 110}))}};
    const size_t bumps = add_texture(glb, studs());
    material["normalTexture"] = {
        {"index", bumps}, {"scale", 0.6}, {"extensions", {{"KHR_texture_transform", {{"scale", {3, 3}}}}}}};
    add_mesh(glb, rectangle({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), material);
}

render::SetLight key_light() {
    render::SetLight light;
    light.kind = render::SetLightKind::kSpot;
    light.position = {1.6, 3, 1.4};
    light.direction = glm::normalize(glm::dvec3(-0.1, 0.2, -0.1) - light.position);
    light.colour = glm::dvec3(48, 44, 38);
    light.inner_cos = std::cos(0.3);
    light.outer_cos = std::cos(0.42);
    light.casts_shadow = true;
    return light;
}

render::SetLight fill_light() {
    render::SetLight light;
    light.kind = render::SetLightKind::kPoint;
    light.position = {-1.4, 0.9, 0.9};
    light.colour = {0.6, 1.2, 2.4};
    light.range_m = 4;
    return light;
}

// Balls of chrome, red plastic and gold on studded tiles, a column, a spot light with shadows, a blue point light, a
// sky.
GoldenSet spot_set() {
    GlbBuilder glb;
    add_floor(glb);
    add_mesh(glb, sphere({-0.75f, 0.4f, 0}, 0.4f, 48), pbr_material({0.95f, 0.95f, 0.95f, 1}, 1, 0.08));
    add_mesh(glb, sphere({0.1f, 0.35f, 0.55f}, 0.35f, 48), pbr_material({0.8f, 0.05f, 0.04f, 1}, 0, 0.3));
    add_mesh(glb, sphere({0.85f, 0.3f, -0.1f}, 0.3f, 48), pbr_material({1, 0.77f, 0.34f, 1}, 1, 0.4));
    json& column = add_mesh(glb, sphere({0, 0, 0}, 0.2f, 32), pbr_material({0.7f, 0.7f, 0.7f, 1}, 0, 0.9));
    column["translation"] = {0, 0.7, -0.8};
    column["scale"] = {1, 4, -1};
    GoldenSet set;
    set.name = "set_spot";
    set.scene = scene_of(glb);
    set.environment = sky();
    set.camera = look_at({0.5, 1.1, 3}, {0, 0.6, 0}, kSetSize * kTexels, kSetSize * kTexels, 1.15);
    set.lights = {key_light(), fill_light()};
    set.ambient.environment_intensity = 0.6;
    set.ambient.show_environment = true;
    return set;
}

// Three lit panes of glass, one behind the other, over a floor. In the right half of the image a volume is assumed
// between the second and the third pane.
GoldenSet pane_set() {
    GlbBuilder glb;
    add_floor(glb);
    const glm::vec4 colours[] = {{0.9f, 0.2f, 0.2f, 0.5f}, {0.2f, 0.8f, 0.3f, 0.4f}, {0.2f, 0.3f, 0.9f, 0.6f}};
    for (const int i : {1, 2, 0}) {
        json material = pbr_material(colours[i], 0, 0.2);
        material["alphaMode"] = "BLEND";
        material["doubleSided"] = true;
        const auto shift = static_cast<float>(i);
        add_mesh(glb, rectangle({-0.8f + 0.25f * shift, 0.05f, 0.6f - 0.6f * shift}, {1, 0, 0.15f}, {0, 0.9f, 0}),
                 material);
    }
    GoldenSet set;
    set.name = "set_panes";
    set.scene = scene_of(glb);
    set.camera = look_at({0.4, 1.1, 2.6}, {0, 0.35, 0}, kSetSize * kTexels, kSetSize * kTexels, 1.1);
    set.lights = {key_light()};
    set.ambient.light = {0.12, 0.12, 0.15};
    set.volume_depth_m = 2.9f;
    return set;
}

}  // namespace

std::vector<GoldenSet> golden_sets() {
    std::vector<GoldenSet> sets;
    sets.push_back(spot_set());
    sets.push_back(pane_set());
    return sets;
}

media::Image render_set(const gpu::Device& device, const GoldenSet& set) {
    const uint32_t side = kSetSize * kTexels;
    render::SetRaster raster(device, set.scene, side, side, 1,
                             set.environment.rgba.empty() ? nullptr : &set.environment);
    raster.pose(stage::pose_scene(set.scene, stage::kNoAnimation, 0));
    raster.lighting.light(set.lights, set.ambient);
    if (set.volume_depth_m > 0) {
        std::vector<float> volume(size_t{side} * side, INFINITY);
        for (size_t i = 0; i < volume.size(); ++i)
            if (i % side >= side / 2) volume[i] = set.volume_depth_m;
        gpu::upload(device, raster.targets().volume_depth, volume.data(), volume.size() * sizeof(float));
    }
    const SetImages drawn = draw_set(device, raster, {set.camera});
    std::vector<glm::vec4> pixels(kSetSize * kSetSize, glm::vec4(0));
    for (size_t i = 0; i < drawn.colour.size(); ++i) {
        // The assumed volume is half transparent grey: what lies behind it is darker.
        const bool split = set.volume_depth_m > 0 && i % side >= side / 2;
        const glm::dvec4 light = drawn.front[i] + (1 - drawn.front[i].a) * (split ? 0.5 : 1.0) * drawn.colour[i];
        pixels[i / side / kTexels * kSetSize + i % side / kTexels] += glm::vec4(light) / float{kTexels * kTexels};
    }
    for (glm::vec4& pixel : pixels) pixel.a = 1;
    return render::encode_straight(pixels, kSetSize, kSetSize);
}

}  // namespace neuvv::test
