// The raster of the set against double precision: lights, materials, depth, alpha, poses.
#include "render/set_raster.h"

#include <gtest/gtest.h>

#include <optional>

#include "reference/camera.h"
#include "reference/lights.h"
#include "reference/pbr.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/set_scene.h"

namespace neuvv::test {
namespace {

using SetRasterTest = GpuTest;
using reference::PbrMaterial;

constexpr uint32_t kSide = 48;

// Where a pixel's ray meets a surface, and the surface's normal there.
struct Hit {
    glm::dvec3 place, normal;
};
using Surface = std::function<std::optional<Hit>(const reference::Ray&)>;

// The floor y = 0 for |x|, |z| < half.
Surface floor_of(double half) {
    return [half](const reference::Ray& ray) -> std::optional<Hit> {
        const double t = -ray.origin.y / ray.direction.y;
        const glm::dvec3 place = ray.origin + t * ray.direction;
        if (t <= 0 || std::max(std::abs(place.x), std::abs(place.z)) >= half) return std::nullopt;
        return Hit{place, {0, 1, 0}};
    };
}

Surface ball_of(glm::dvec3 centre, double radius) {
    return [=](const reference::Ray& ray) -> std::optional<Hit> {
        const glm::dvec3 to = centre - ray.origin;
        const double along = glm::dot(to, ray.direction), inside = along * along - glm::dot(to, to) + radius * radius;
        if (inside < 0) return std::nullopt;
        const glm::dvec3 place = ray.origin + (along - std::sqrt(inside)) * ray.direction;
        return Hit{place, (place - centre) / radius};
    };
}

MeshData floor_mesh(float half = 1.5f) {
    return rectangle({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
}

Camera camera_above() {
    return look_at({0.4, 1.3, 2.2}, {0, 0, 0}, kSide, kSide, 1.1);
}

struct Lighting {
    std::vector<SetLight> lights;
    SetAmbient ambient;
};

glm::dvec3 expected_light(const Hit& hit, const glm::dvec3& to_eye, const PbrMaterial& material,
                          const Lighting& lighting) {
    glm::dvec3 sum =
        reference::reflect_ambient(material, hit.normal, to_eye, lighting.ambient.light, lighting.ambient.light);
    for (const SetLight& light : lighting.lights) {
        glm::dvec3 to_light;
        const glm::dvec3 arriving = reference::light_at(light, hit.place, to_light);
        sum += arriving * reference::brdf(material, hit.normal, to_eye, to_light) *
               std::max(glm::dot(hit.normal, to_light), 0.0);
    }
    return sum;
}

struct Agreement {
    double worst = 0;  // of the colour: off by this much of itself and of 0.01
    double depth = 0;  // relative
    size_t covered = 0;
    size_t wrong_cover = 0;  // texels that are covered in one alone
};

// Texels whose neighbours' rays do not all hit, or all miss, are left out: the edge.
bool at_edge(const Surface& surface, const Camera& camera, uint32_t x, uint32_t y) {
    const bool hit = surface(reference::camera_ray(camera, x, y)).has_value();
    for (const double dx : {-0.6, 0.6})
        for (const double dy : {-0.6, 0.6})
            if (surface(reference::camera_ray(camera, x + dx, y + dy)).has_value() != hit) return true;
    return false;
}

Agreement compare(const SetPictures& pictures, const Camera& camera, const Surface& surface,
                  const PbrMaterial& material, const Lighting& lighting, size_t first_texel = 0) {
    Agreement agreement;
    const glm::dvec3 eye(camera.world_from_camera[3]), forward(-camera.world_from_camera[2]);
    for (uint32_t y = 0; y < camera.height; y++)
        for (uint32_t x = 0; x < camera.width; x++) {
            if (at_edge(surface, camera, x, y)) continue;
            const size_t texel = first_texel + size_t{y} * camera.width + x;
            const auto hit = surface(reference::camera_ray(camera, x, y));
            const glm::dvec4 drawn = pictures.colour[texel];
            const float metres = pictures.depth_m[texel];
            agreement.wrong_cover +=
                hit ? drawn.a != 1 || std::isinf(metres) : drawn != glm::dvec4(0) || metres != INFINITY;
            if (!hit) continue;
            agreement.covered++;
            const glm::dvec3 truth = expected_light(*hit, glm::normalize(eye - hit->place), material, lighting);
            for (int c = 0; c < 3; c++) {
                const double error = std::abs(drawn[c] - truth[c]) / (truth[c] + 0.01);
                agreement.worst = std::isnan(error) ? INFINITY : std::max(agreement.worst, error);
            }
            const double along = glm::dot(hit->place - eye, forward);
            agreement.depth = std::max(agreement.depth, std::abs(metres - along) / along);
        }
    return agreement;
}

// fp16 has steps of 1/2048 of a value, of which rounding is half; the rest is single precision in sharp highlights.
constexpr double kColourTolerance = 2e-3;
constexpr double kDepthTolerance = 2e-6;

SetPictures draw(const Device& device, const GlbBuilder& glb, const Camera& camera, const Lighting& lighting) {
    const GltfScene scene = scene_of(glb);
    SetRaster set(device, scene, camera.width, camera.height, 1);
    set.pose(pose_scene(scene, kNoAnimation, 0));
    set.light(lighting.lights, lighting.ambient);
    return draw_set(device, set, {camera});
}

SetLight directional() {
    SetLight light;
    light.kind = SetLightKind::kDirectional;
    light.direction = glm::normalize(glm::dvec3(0.4, -1, -0.3));
    light.colour = {2, 1.5, 1};
    return light;
}

SetLight point() {
    SetLight light;
    light.kind = SetLightKind::kPoint;
    light.position = {-0.7, 0.9, 0.5};
    light.colour = {1, 2, 3};
    return light;
}

SetLight spot() {
    SetLight light;
    light.kind = SetLightKind::kSpot;
    light.position = {0.8, 1.6, 0.6};
    light.direction = glm::normalize(glm::dvec3(-0.6, -1.5, -0.5));
    light.colour = {5, 4, 3};
    light.inner_cos = std::cos(0.2);
    light.outer_cos = std::cos(0.5);
    return light;
}

TEST_F(SetRasterTest, APlaneUnderEachKindOfLight) {
    SetLight ranged = point();
    ranged.range_m = 1.4;
    const std::pair<const char*, std::vector<SetLight>> cases[] = {{"directional", {directional()}},
                                                                   {"point", {point()}},
                                                                   {"point with a range", {ranged}},
                                                                   {"spot", {spot()}},
                                                                   {"all", {directional(), ranged, spot(), point()}}};
    const PbrMaterial materials[] = {
        {{0.8, 0.5, 0.2}, 0, 0.7}, {{0.9, 0.6, 0.3}, 1, 0.35}, {{0.2, 0.7, 0.9}, 0.5, 0.5}};
    for (const auto& [name, lights] : cases)
        for (const PbrMaterial& material : materials) {
            GlbBuilder glb;
            add_mesh(glb, floor_mesh(),
                     pbr_material(glm::vec4(material.base_colour, 1), material.metallic, material.roughness));
            const Lighting lighting{lights, {}};
            const Agreement agreement = compare(draw(device(), glb, camera_above(), lighting), camera_above(),
                                                floor_of(1.5), material, lighting);
            EXPECT_LT(agreement.worst, kColourTolerance) << name << ", metallic " << material.metallic;
            EXPECT_LT(agreement.depth, kDepthTolerance) << name;
            EXPECT_EQ(agreement.wrong_cover, 0u) << name;
            EXPECT_GT(agreement.covered, 800u) << name;
        }
}

TEST_F(SetRasterTest, ABallUnderAllLights) {
    const PbrMaterial material{{0.9, 0.3, 0.2}, 0.2, 0.45};
    GlbBuilder glb;
    add_mesh(glb, sphere({0, 0.2f, 0}, 0.7f, 256), pbr_material({0.9f, 0.3f, 0.2f, 1}, 0.2, 0.45));
    Lighting lighting{{directional(), point(), spot()}, {}};
    lighting.ambient.light = {0.1, 0.2, 0.3};
    const Agreement agreement = compare(draw(device(), glb, camera_above(), lighting), camera_above(),
                                        ball_of({0, 0.2, 0}, 0.7), material, lighting);
    // The mesh's flat triangles lie 3e-5 of the radius below the ball at most, more where they are seen from the side.
    EXPECT_LT(agreement.worst, 1e-2);
    EXPECT_LT(agreement.depth, 5e-4);
    EXPECT_EQ(agreement.wrong_cover, 0u);
    EXPECT_GT(agreement.covered, 400u);
}

TEST_F(SetRasterTest, TheComparisonNoticesOtherLightsAndMaterials) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.7));
    const Lighting lighting{{spot()}, {}};
    const SetPictures drawn = draw(device(), glb, camera_above(), lighting);
    const PbrMaterial material{{0.8, 0.5, 0.2}, 0, 0.7};
    ASSERT_LT(compare(drawn, camera_above(), floor_of(1.5), material, lighting).worst, kColourTolerance);
    Lighting other = lighting;
    other.lights[0].inner_cos = std::cos(0.21);
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.5), material, other).worst, kColourTolerance);
    PbrMaterial rougher = material;
    rougher.roughness = 0.72;
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.5), rougher, lighting).worst, kColourTolerance);
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.4), material, lighting).wrong_cover, 0u);
    Camera nearer = camera_above();
    nearer.world_from_camera[3] *= 0.9999;
    EXPECT_GT(compare(drawn, nearer, floor_of(1.5), material, lighting).depth, kDepthTolerance);
}

TEST_F(SetRasterTest, ViewsStandBehindEachOther) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.7));
    const GltfScene scene = scene_of(glb);
    const Lighting lighting{{spot()}, {}};
    const Camera other = look_at({-0.7, 0.9, 1.8}, {0.2, 0, 0}, kSide, kSide, 0.9);
    SetRaster set(device(), scene, kSide, kSide, 3);
    set.pose(pose_scene(scene, kNoAnimation, 0));
    set.light(lighting.lights, lighting.ambient);
    const SetPictures drawn = draw_set(device(), set, {camera_above(), other});
    const PbrMaterial material{{0.8, 0.5, 0.2}, 0, 0.7};
    EXPECT_LT(compare(drawn, camera_above(), floor_of(1.5), material, lighting).worst, kColourTolerance);
    EXPECT_LT(compare(drawn, other, floor_of(1.5), material, lighting, kSide * kSide).worst, kColourTolerance);
    EXPECT_EQ(drawn.depth_m[2 * kSide * kSide + 77], INFINITY) << "the view without a camera";
}

TEST_F(SetRasterTest, WhiteInUniformLightStaysWhite) {
    for (const double roughness : {0.0, 0.3, 1.0})
        for (const bool by_picture : {false, true}) {
            GlbBuilder glb;
            add_mesh(glb, sphere({0, 0.2f, 0}, 0.7f, 64), pbr_material(glm::vec4(1), 0, roughness));
            const GltfScene scene = scene_of(glb);
            const Image white = one_colour(255, 255, 255);
            SetRaster set(device(), scene, kSide, kSide, 1, by_picture ? &white : nullptr);
            set.pose(pose_scene(scene, kNoAnimation, 0));
            SetAmbient ambient;
            ambient.light = glm::dvec3(by_picture ? 0 : 1);
            set.light({}, ambient);
            const SetPictures drawn = draw_set(device(), set, {camera_above()});
            size_t covered = 0;
            for (const glm::dvec4& light : drawn.colour) {
                if (light.a == 0) continue;
                covered++;
                for (int c = 0; c < 3; c++) ASSERT_NEAR(light[c], 1, 2e-3) << roughness << " " << by_picture;
            }
            EXPECT_GT(covered, 400u);
        }
}

}  // namespace
}  // namespace neuvv::test
