// Shadows of the set and of performers, against analytic rays to the lights.
#include <fmt/format.h>

#include <glm/gtc/constants.hpp>

#include "gpu/commands.h"
#include "gpu/host_copies.h"
#include "render/light_probe.h"
#include "render/set/set_raster.h"
#include "render/set_truth.h"
#include "spirv/light_probe.comp.h"
#include "support/gpu_test.h"

namespace neuvv::test::set_shadow_test {
namespace {

using SetShadowTest = GpuTest;

const PbrMaterial kMaterial{{0.8, 0.5, 0.2}, 0, 0.8};
constexpr float kHeight = 0.5f, kHalf = 0.3f;  // of the plate over the floor
constexpr double kPenumbra = 0.03;             // metres from the plate's edge, on its plane, that are not compared

// A floor with a plate above it that faces up.
GlbBuilder plate_over_floor(const json& plate_material) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.8));
    add_mesh(glb, rectangle({-kHalf, kHeight, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}), plate_material);
    return glb;
}

render::SetLight spot_above() {
    render::SetLight light = spot();
    light.position = {0.3, 2, 0.2};
    light.direction = glm::normalize(glm::dvec3(0, 0, 0) - light.position);
    light.inner_cos = std::cos(0.4);
    light.outer_cos = std::cos(0.6);
    light.colour = {20, 16, 12};
    light.casts_shadow = true;
    return light;
}

render::SetLight sun() {
    render::SetLight light = directional();
    light.casts_shadow = true;
    return light;
}

double plate_visible(const render::SetLight& light, glm::dvec3 position) {
    if (light.kind == render::SetLightKind::kPoint) return 1;
    const glm::dvec3 to =
        light.kind == render::SetLightKind::kDirectional ? -light.direction : glm::normalize(light.position - position);
    const glm::dvec3 there = position + to * (static_cast<double>(kHeight) - position.y) / to.y;
    const double outside = std::max(std::abs(there.x), std::abs(there.z)) - static_cast<double>(kHalf);
    return std::abs(outside) < kPenumbra ? -1 : outside > 0 ? 1 : 0;
}

// The floor where the plate does not hide it.
Surface floor_beside_plate() {
    return [](const reference::Ray& ray) -> std::optional<Hit> {
        const auto hit = floor_of(1.5)(ray);
        const double t = (static_cast<double>(kHeight) - ray.origin.y) / ray.direction.y;
        const glm::dvec3 there = ray.origin + t * ray.direction;
        const bool hidden = t > 0 && std::max(std::abs(there.x), std::abs(there.z)) < static_cast<double>(kHalf) + 0.05;
        return hidden ? std::nullopt : hit;
    };
}

// Compares only the texels of the floor, not those of the plate.
Agreement floor_agreement(const SetImages& drawn, const Lighting& lighting) {
    Agreement agreement = compare(drawn, camera_above(), floor_beside_plate(), kMaterial, lighting);
    EXPECT_GT(agreement.covered, 500u);
    return agreement;
}

Lighting plate_lighting(const std::vector<render::SetLight>& lights) {
    Lighting lighting{lights, {}};
    lighting.ambient.light = glm::dvec3(0.05);
    lighting.visible = plate_visible;
    return lighting;
}

TEST_F(SetShadowTest, APlateShadowsTheFloor) {
    render::SetLight lamp = point();
    lamp.casts_shadow = true;  // has no effect: point lights have no map
    const std::pair<const char*, std::vector<render::SetLight>> cases[] = {
        {"spot", {spot_above()}}, {"sun", {sun()}}, {"both and a lamp", {spot_above(), lamp, sun()}}};
    for (const auto& [name, lights] : cases) {
        const GlbBuilder glb = plate_over_floor(pbr_material(glm::vec4(1), 0, 1));
        const Lighting lighting = plate_lighting(lights);
        const SetImages drawn = draw(device(), glb, camera_above(), lighting);
        EXPECT_LT(floor_agreement(drawn, lighting).worst, kColourTolerance) << name;
        Lighting unshadowed = lighting;
        unshadowed.visible = [](const render::SetLight&, glm::dvec3) { return 1.0; };
        EXPECT_GT(floor_agreement(drawn, unshadowed).worst, 0.5) << name << ": there is a shadow";
    }
}

TEST_F(SetShadowTest, BlendedAndCutOutPiecesCastNone) {
    for (const char* mode : {"BLEND", "MASK"}) {
        json material = pbr_material({1, 1, 1, 0.2f}, 0, 1);
        material["alphaMode"] = mode;
        Lighting lighting = plate_lighting({spot_above()});
        lighting.visible = [](const render::SetLight&, glm::dvec3) { return 1.0; };
        const SetImages drawn = draw(device(), plate_over_floor(material), camera_above(), lighting);
        EXPECT_LT(floor_agreement(drawn, lighting).worst, kColourTolerance) << mode;
    }
}

TEST_F(SetShadowTest, CanBeTurnedOffAndAreDrawnAgainOnlyForChanges) {
    const stage::GltfScene scene = scene_of(plate_over_floor(pbr_material(glm::vec4(1), 0, 1)));
    render::SetRaster set(device(), scene, kSide, kSide, 1);
    const stage::PosedScene pose = stage::pose_scene(scene, stage::kNoAnimation, 0);
    const Lighting lighting = plate_lighting({spot_above()});
    set.pose(pose);
    set.lighting.light(lighting.lights, lighting.ambient);
    const auto maps_drawn = [&] {
        gpu::Commands commands(device());
        commands.begin();
        set.lighting.record_lights(commands);
        set.record_shadows(commands);
        commands.submit();
        commands.wait();
        return commands.pass_times().size();
    };
    EXPECT_EQ(maps_drawn(), 1u);
    set.pose(pose);
    set.lighting.light(lighting.lights, lighting.ambient);
    EXPECT_EQ(maps_drawn(), 0u) << "nothing moved";
    Lighting unshadowed = lighting;
    unshadowed.visible = [](const render::SetLight&, glm::dvec3) { return 1.0; };
    set.lighting.light(lighting.lights, lighting.ambient, {.set = false});
    EXPECT_EQ(maps_drawn(), 0u);
    EXPECT_LT(floor_agreement(draw_set(device(), set, {camera_above()}), unshadowed).worst, kColourTolerance);
    set.lighting.light(lighting.lights, lighting.ambient);
    EXPECT_LT(floor_agreement(draw_set(device(), set, {camera_above()}), lighting).worst, kColourTolerance);
    stage::PosedScene moved = pose;
    moved.world_from_node[1][3].x = 0.4;
    set.pose(moved);
    EXPECT_EQ(maps_drawn(), 1u);
    render::SetLight other = spot_above();
    other.position.y += 0.1;
    set.lighting.light(std::span(&other, 1), lighting.ambient);
    EXPECT_EQ(maps_drawn(), 1u);
    const std::vector<render::SetLight> many(40, other);
    set.lighting.light(many, lighting.ambient);
    EXPECT_EQ(set.lighting.lights().count, kMaxSetLights);
    EXPECT_EQ(maps_drawn(), kMaxShadows);
}

// No light leaks through the foot of a wall, and no wall shadows itself: a box of five faces over the floor.
TEST_F(SetShadowTest, AWallMeetsItsShadow) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.8));
    json material = pbr_material(glm::vec4(1), 0, 1);
    material["doubleSided"] = true;
    add_mesh(glb, rectangle({0.2f, 0, 1}, {0, 0, -2}, {0, 1, 0}), material);  // x = 0.2
    render::SetLight light = sun();
    light.direction = glm::normalize(glm::dvec3(-1, -1, 0));
    Lighting lighting{{light}, {}};
    // Behind the wall, seen from the light: 0.2 − 1 < x < 0.2. The filter has a radius of 3 texels of 3 m / 1024, and
    // the bias is as large.
    lighting.visible = [](const render::SetLight&, glm::dvec3 p) {
        if (std::abs(p.z) > 0.9) return -1.0;
        if (p.x > 0.2) return 1.0;
        return p.x > 0.2 - 0.02 || std::abs(p.x + 0.8) < 0.03 ? -1.0 : p.x > -0.8 ? 0.0 : 1.0;
    };
    const stage::Camera camera = look_at({-2, 1.6, 0.3}, {-0.4, 0, 0}, kSide, kSide, 1.2);
    const Surface floor_before_wall = [](const reference::Ray& ray) -> std::optional<Hit> {
        const auto hit = floor_of(1.5)(ray);
        return hit && hit->position.x < 0.19 ? hit : std::nullopt;
    };
    const SetImages drawn = draw(device(), glb, camera, lighting);
    const Agreement agreement = compare(drawn, camera, floor_before_wall, kMaterial, lighting);
    EXPECT_LT(agreement.worst, kColourTolerance);
    EXPECT_GT(agreement.covered, 500u);
}

// A rectangle that faces the lamp, without its edges.
Surface plane_of(glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v) {
    const glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    return [=](const reference::Ray& ray) -> std::optional<Hit> {
        const double t = glm::dot(corner - ray.origin, normal) / glm::dot(ray.direction, normal);
        const glm::dvec3 position = ray.origin + t * ray.direction, from = position - corner;
        const double a = glm::dot(from, u) / glm::dot(u, u), b = glm::dot(from, v) / glm::dot(v, v);
        if (t <= 0 || std::min(a, b) < 0.02 || std::max(a, b) > 0.98) return std::nullopt;
        return Hit{position, normal};
    };
}

// A lamp that shines straight down with a wide cone: what it reaches from the side has no stripes of its own shadow,
// though it faces the light and the map sees it at a steep angle.
TEST_F(SetShadowTest, WideConesLeaveNoStripes) {
    const struct {
        const char* name;
        glm::vec3 corner, u, v;
    } planes[] = {{"floor", {0.5f, 0, 0.5f}, {1.5f, 0, 0}, {0, 0, -1}},
                  {"wall", {1.5f, 0, -0.5f}, {0, 0, 1}, {0, 0.8f, 0}},
                  {"slope", {1.2f, 0, -0.5f}, {0, 0, 1}, {0.5f, 0.5f, 0}}};
    for (const double degrees : {40.0, 60.0, 70.0, 78.0})
        for (const auto& plane : planes) {
            SCOPED_TRACE(fmt::format("{} at {}°", plane.name, degrees));
            render::SetLight lamp = spot();
            lamp.position = {0, 1.2, 0};
            lamp.direction = {0, -1, 0};
            lamp.inner_cos = 1;
            lamp.outer_cos = std::cos(glm::radians(degrees));
            lamp.colour = {200, 200, 200};
            lamp.casts_shadow = true;
            GlbBuilder glb;
            json material = pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.8);
            material["doubleSided"] = true;
            add_mesh(glb, rectangle(plane.corner, plane.u, plane.v), material);
            Lighting lighting{{lamp}, {}};
            lighting.ambient.light = glm::dvec3(0.5);
            const stage::Camera camera = look_at({-1, 1.2, 0.3}, {1.3, 0.3, 0}, kSide, kSide, 1.4);
            const SetImages drawn = draw(device(), glb, camera, lighting);
            const Agreement agreement =
                compare(drawn, camera, plane_of(plane.corner, plane.u, plane.v), kMaterial, lighting);
            EXPECT_LT(agreement.worst, kColourTolerance);
            EXPECT_GT(agreement.covered, 100u);
        }
}

TEST_F(SetShadowTest, PerformersShadowWhatLiesBehindThem) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.8));
    const stage::GltfScene scene = scene_of(glb);
    render::SetRaster set(device(), scene, kSide, kSide, 1);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    Lighting lighting{{sun(), spot_above()}, {}};
    set.lighting.light(lighting.lights, lighting.ambient);
    const render::WorldBox performers{glm::dvec3(-0.7, 0, -0.7), glm::dvec3(0.7, 0.9, 0.7)};
    set.lighting.set_shadow_casters(performers);
    const uint32_t side = kPerformerShadowSide;
    const auto worst = [&](const Lighting& wanted) {
        return compare(draw_set(device(), set, {camera_above()}), camera_above(), floor_of(1.5), kMaterial, wanted)
            .worst;
    };
    const Lighting unshadowed{lighting.lights, {}};
    for (const uint32_t shadow : {0u, 1u}) {
        SCOPED_TRACE(shadow);
        const render::SetLight& from = lighting.lights[shadow];
        ASSERT_EQ(set.lighting.lights().light[shadow].shadow, shadow);
        // The lower right quarter of its image, 1 m from it.
        std::vector<glm::vec2> maps(kMaxShadows * side * side, glm::vec2(0));
        for (size_t i = 0; i < side * side; ++i)
            if (i % side >= side / 2 && i / side >= side / 2) maps[shadow * side * side + i] = {0.75f, 1};
        gpu::upload(device(), set.lighting.performer_shadows, maps.data(), maps.size() * sizeof(glm::vec2));
        const stage::Camera light_camera = render::performer_shadow_camera(from, performers, side);
        lighting.visible = [&](const render::SetLight& light, glm::dvec3 position) {
            if (light.kind != from.kind) return 1.0;
            const glm::dvec3 p(glm::inverse(light_camera.world_from_camera) * glm::dvec4(position, 1));
            const glm::dvec2 from_centre(-light_camera.fx * p.x / p.z,
                                         light_camera.fy * p.y / p.z);  // texels, to the right and down
            const double inside = std::min(from_centre.x, from_centre.y);
            const double outside = std::max(from_centre.x, from_centre.y) - side / 2.0;
            if (std::abs(inside) < 1 || std::abs(outside) < 1) return -1.0;
            return inside < 0 || outside > 0 ? 1.0 : 0.25;
        };
        EXPECT_LT(worst(lighting), kColourTolerance);
        EXPECT_GT(worst(unshadowed), 0.3) << "there is a shadow";
        set.lighting.light(lighting.lights, lighting.ambient, {.performers = false});
        EXPECT_LT(worst(unshadowed), kColourTolerance);
        set.lighting.light(lighting.lights, lighting.ambient);
        for (glm::vec2& texel : maps) texel.y = 1e6f;  // behind the floor
        gpu::upload(device(), set.lighting.performer_shadows, maps.data(), maps.size() * sizeof(glm::vec2));
        EXPECT_LT(worst(unshadowed), kColourTolerance);
    }
}

TEST_F(SetShadowTest, ACatcherShowsPerformersShadowsAlone) {
    constexpr double kFloor_m = -0.1, kAlpha = 0.75;
    const stage::GltfScene scene = scene_of(plate_over_floor(pbr_material(glm::vec4(1), 0, 1)));
    render::SetRaster set(device(), scene, kSide, kSide, 1);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    const std::vector<render::SetLight> lights{sun(), spot_above(), point()};
    render::SetAmbient ambient;
    ambient.light = glm::dvec3(0.1, 0.2, 0.3);
    set.lighting.light(lights, ambient);
    set.lighting.set_shadow_casters(render::WorldBox{glm::dvec3(-0.7, 0, -0.7), glm::dvec3(0.7, 0.9, 0.7)});
    // The whole map of the spot has a performer 1 m before it.
    const size_t texels = kPerformerShadowSide * kPerformerShadowSide;
    std::vector<glm::vec2> maps(kMaxShadows * texels, glm::vec2(0));
    std::fill_n(maps.begin() + static_cast<ptrdiff_t>(texels), texels, glm::vec2(kAlpha, 1));
    gpu::upload(device(), set.lighting.performer_shadows, maps.data(), maps.size() * sizeof(glm::vec2));

    const SetImages with_set = draw_set(device(), set, {camera_above()});
    set.catch_shadows(kFloor_m);
    const SetImages caught = draw_set(device(), set, {camera_above()});
    const auto luminance = [](glm::dvec3 light) { return glm::dot(light, glm::dvec3(0.2126, 0.7152, 0.0722)); };
    double darkest = 0;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const reference::Ray ray = reference::camera_ray(camera_above(), x, y);
            const double t = (kFloor_m - ray.origin.y) / ray.direction.y;
            const glm::dvec4 seen = caught.colour[y * kSide + x];
            ASSERT_EQ(glm::dvec3(seen), glm::dvec3(0)) << "neither floor nor plate";
            if (t <= 0) continue;
            double lit = luminance(ambient.light), taken = 0;
            for (size_t i = 0; i < lights.size(); ++i) {
                glm::dvec3 to_light;
                const glm::dvec3 arriving = reference::light_at(lights[i], ray.origin + t * ray.direction, to_light);
                const double reflected = luminance(arriving) * std::max(to_light.y, 0.0) / glm::pi<double>();
                lit += reflected;
                if (i == 1) taken += kAlpha * reflected;
            }
            ASSERT_NEAR(seen.a, taken / lit, 2e-3) << x << " " << y;
            darkest = std::max(darkest, taken / lit);
        }
    EXPECT_GT(darkest, 0.3) << "there is a shadow";
    set.catch_shadows({});
    EXPECT_EQ(draw_set(device(), set, {camera_above()}).colour, with_set.colour) << "the set is back";
}

TEST_F(SetShadowTest, ComputeShadersLightAlike) {
    const stage::GltfScene scene = scene_of(plate_over_floor(pbr_material(glm::vec4(1), 0, 1)));
    render::SetRaster set(device(), scene, kSide, kSide, 1);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    const std::vector<render::SetLight> lights{sun(), point(), spot_above()};
    set.lighting.light(lights, {});
    std::vector<glm::vec4> positions;
    for (int i = 0; i < 500; ++i)
        positions.emplace_back(0.003 * (i * 37 % 331) - 0.5, 0.001 * (i * 53 % 331) + 0.02,
                               0.003 * (i * 71 % 331) - 0.5, 0);
    const auto bytes = positions.size() * sizeof(glm::vec4);
    const gpu::Buffer in(device(), "places", bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32B32A32_SFLOAT);
    const gpu::Buffer out(device(), "results", 6 * bytes, gpu::MemoryKind::kReadback, VK_FORMAT_R32G32B32A32_SFLOAT);
    gpu::upload(device(), in, positions.data(), bytes);
    const gpu::ComputePass pass(device(), "light probe", light_probe_comp);
    const gpu::BindingSet bindings(pass, {{kProbePositions, &in},
                                          {kProbeLights, &set.lighting.lights_buffer},
                                          {kProbeSetShadows, &set.lighting.set_shadow_maps},
                                          {kProbePerformerShadows, &set.lighting.performer_shadows},
                                          {kProbeOut, &out}});
    gpu::run_once(device(), "light probe", [&](gpu::Commands& commands) {
        set.lighting.record_lights(commands);
        set.record_shadows(commands);
        const LightProbePush push{static_cast<uint32_t>(positions.size())};
        gpu::dispatch(commands, pass, bindings, positions.size(), push);
    });
    int lit = 0, dark = 0;
    for (size_t p = 0; p < positions.size(); ++p)
        for (size_t i = 0; i < lights.size(); ++i) {
            const glm::vec4* result = out.as<glm::vec4>() + 2 * (p * lights.size() + i);
            glm::dvec3 to_light;
            const glm::dvec3 light = reference::light_at(lights[i], glm::dvec3(positions[p]), to_light);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(result[0][c], light[c], 1e-4 * (1 + light[c]));
                EXPECT_NEAR(result[1][c], to_light[c], 1e-5);
            }
            EXPECT_EQ(result[1].w, 1) << "no performer is there";
            const double visible = plate_visible(lights[i], glm::dvec3(positions[p]));
            if (visible < 0) continue;
            EXPECT_NEAR(result[0].w, visible, 1e-3) << "light " << i;
            (visible > 0 ? lit : dark)++;
            if (HasFailure()) return;
        }
    EXPECT_GT(lit, 400);
    EXPECT_GT(dark, 50);
}

}  // namespace
}  // namespace neuvv::test::set_shadow_test
