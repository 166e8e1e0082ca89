// The environment of a stage: irradiance and blurred levels against quadrature, and the background behind the set.
#include "render/set/environment.h"

#include "render/set_truth.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

using EnvironmentTest = GpuTest;

// A smooth light: polynomials of degree 2, which nine SH functions represent exactly.
glm::dvec3 smooth_light(glm::dvec3 d) {
    return {0.4 + 0.3 * d.y, 0.35 + 0.2 * d.x - 0.1 * d.z, 0.3 + 0.2 * d.x * d.z + 0.15 * d.y * d.y};
}

media::Image smooth_image(uint32_t height) {
    media::Image image(2 * height, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < 2 * height; ++x) {
            const glm::dvec3 light =
                smooth_light(render::environment_direction((x + 0.5) / (2.0 * height), (y + 0.5) / height));
            for (int c = 0; c < 3; ++c) image.at(x, y)[c] = media::srgb_byte_from_linear(static_cast<float>(light[c]));
            image.at(x, y)[3] = 255;
        }
    return image;
}

glm::dvec3 value_of(const render::Irradiance& irradiance, glm::dvec3 n) {
    const double basis[9] = {
        1, n.y, n.z, n.x, n.x * n.y, n.y * n.z, 3 * n.z * n.z - 1, n.x * n.z, n.x * n.x - n.y * n.y};
    glm::dvec3 sum(0);
    for (size_t i = 0; i < 9; ++i) sum += basis[i] * irradiance[i];
    return sum;
}

std::vector<glm::dvec3> some_directions() {
    std::vector<glm::dvec3> directions;
    for (int i = 0; i < 24; ++i)
        directions.push_back(glm::normalize(glm::dvec3(std::sin(i * 1.7), std::cos(i * 2.3), std::sin(i * 0.9 + 1))));
    return directions;
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << "channel " << c;
}

TEST(EnvironmentLight, IrradianceIsTheIntegral) {
    const render::Environment environment = render::make_environment(smooth_image(128));
    for (const glm::dvec3& n : some_directions())
        // Rounding to 8 bits of sRGB is an error of 0.002 of light at most, and averages out.
        expect_near(value_of(environment.irradiance, n), reference::irradiance(smooth_light, n, 256), 5e-4);
    EXPECT_GT(std::abs(value_of(environment.irradiance, {0, 1, 0}).r - value_of(environment.irradiance, {0, -1, 0}).r),
              0.3);
}

TEST(EnvironmentLight, WideImagesAreTakenDown) {
    media::Image image(8200, 12);  // a little more than four times the largest width
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x) image.at(x, y)[x % 2] = 255;  // red, green, red, ...
    const render::Environment environment = render::make_environment(image);
    EXPECT_EQ(environment.width, 1025u);
    EXPECT_EQ(environment.height, 1u);
    for (size_t i = 0; i < environment.levels[0].size(); i += 4) {
        EXPECT_EQ(voctree::float_from_half(environment.levels[0][i]), 0.5f);
        EXPECT_EQ(voctree::float_from_half(environment.levels[0][i + 1]), 0.5f);
    }
    expect_near(value_of(environment.irradiance, {0, 0, 1}), {0.5, 0.5, 0}, 1e-4);
}

TEST(EnvironmentLight, TurnsWithItsImage) {
    const render::Environment environment = render::make_environment(smooth_image(64));
    const double angle = 0.7;
    const render::Irradiance by_angle = render::turned(environment.irradiance, angle);
    const glm::dmat3 back(std::cos(angle), 0, std::sin(angle), 0, 1, 0, -std::sin(angle), 0, std::cos(angle));
    for (const glm::dvec3& n : some_directions())
        expect_near(value_of(by_angle, n), value_of(environment.irradiance, back * n), 1e-12);
}

// ∫ L(l) N·L p(l) dl / ∫ N·L p(l) dl with N = V and p of GGX, as the mip levels store it.
glm::dvec3 mirrored(glm::dvec3 n, double roughness) {
    const double alpha2 = std::pow(roughness, 4);
    glm::dvec3 sum(0);
    double weights = 0;
    constexpr int kRows = 400;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < 2 * kRows; ++column) {
            const double v = (row + 0.5) / kRows;
            const glm::dvec3 d = render::environment_direction((column + 0.5) / (2.0 * kRows), v);
            const double nl = glm::dot(n, d);
            if (nl <= 0) continue;
            const double nh = glm::dot(n, glm::normalize(n + d)), lobe = nh * nh * (alpha2 - 1) + 1;
            const double weight = nl / (lobe * lobe) * std::sin(std::numbers::pi * v);
            sum += weight * smooth_light(d);
            weights += weight;
        }
    return sum / weights;
}

TEST(EnvironmentLight, LevelsAreBlurredAsRoughSurfacesMirror) {
    const render::Environment environment = render::make_environment(smooth_image(128));
    ASSERT_EQ(environment.levels.size(), 5u);
    for (size_t level = 1; level < environment.levels.size(); ++level) {
        const uint32_t width = environment.width >> level, height = environment.height >> level;
        for (const auto& [x, y] : {std::pair{3u, 2u}, {width / 2, height / 2}, {width - 1, height - 2}}) {
            const uint16_t* texel = &environment.levels[level][4 * (size_t{y} * width + x)];
            const glm::dvec3 n = render::environment_direction((x + 0.5) / width, (y + 0.5) / height);
            // The light varies by 0.6 over the sphere, and a sample has the size of a texel of a coarse level.
            expect_near({voctree::float_from_half(texel[0]), voctree::float_from_half(texel[1]),
                         voctree::float_from_half(texel[2])},
                        mirrored(n, static_cast<double>(level) / 4), 0.012);
        }
    }
}

TEST(EnvironmentLight, TheFitOfTheSplitSumIsNearTheIntegral) {
    for (const double roughness : {0.05, 0.1, 0.3, 0.5, 0.7, 1.0})
        for (const double nv : {0.05, 0.2, 0.5, 0.8, 1.0}) {
            const glm::dvec2 exact = reference::specular_albedo(roughness, nv, 200);
            const glm::dvec3 eye(std::sqrt(1 - nv * nv), 0, nv), normal(0, 0, 1), black(0), white(1);
            for (const double f0 : {0.04, 0.5, 1.0}) {
                const PbrMaterial metal{glm::dvec3(f0), 1, roughness};
                EXPECT_NEAR(reference::reflect_ambient(metal, normal, eye, black, white).r, f0 * exact.x + exact.y,
                            0.045)
                    << "roughness " << roughness << ", cosine " << nv << ", f0 " << f0;
            }
        }
}

TEST_F(EnvironmentTest, StandsBehindTheSetAndTurns) {
    GlbBuilder glb;
    add_mesh(glb, rectangle({-0.2f, -0.2f, 0}, {0.4f, 0, 0}, {0, 0.4f, 0}), pbr_material(glm::vec4(1), 0, 1));
    const stage::GltfScene scene = scene_of(glb);
    const media::Image image = smooth_image(128);
    render::SetRaster set(device(), scene, kSide, kSide, 1, &image);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    const stage::Camera camera = look_at({0.3, 0.8, 1.6}, {0, 0, 0}, kSide, kSide, 0.5);
    render::SetAmbient ambient;
    ambient.environment_intensity = 2;
    ambient.environment_rotation = 0.9;
    set.lighting.light({}, ambient);
    EXPECT_EQ(draw_set(device(), set, {camera}).colour[0].a, 0) << "not requested";
    ambient.show_environment = true;
    set.lighting.light({}, ambient);
    const SetImages drawn = draw_set(device(), set, {camera});
    const double c = std::cos(0.9), s = std::sin(0.9);
    const glm::dmat3 back(c, 0, s, 0, 1, 0, -s, 0, c);
    size_t beside = 0;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const size_t texel = y * kSide + x;
            ASSERT_EQ(drawn.colour[texel].a, 1);
            if (drawn.depth_m[texel] != INFINITY) continue;
            ++beside;
            expect_near(glm::dvec3(drawn.colour[texel]),
                        2.0 * smooth_light(back * reference::camera_ray(camera, x, y).direction), 0.012);
        }
    EXPECT_GT(beside, 2000u);
    EXPECT_LT(beside, 2300u) << "the rectangle stands before it";
}

}  // namespace
}  // namespace neuvv::test
