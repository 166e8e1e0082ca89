#include "render/set/raster.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/platform.h"
#include "tests/stage/glb_builder.h"
#include "voctree/files/half.h"

namespace neuvv {
namespace {

using test::GlbBuilder;
using test::json;

constexpr uint32_t kSide = 64;

const gpu::Device& device() {
    static const gpu::Device shared("", gpu::Validation::kOn);
    return shared;
}

// 2 m before the plane z = 0, where a metre is 32 pixels. The principal point is not the centre.
stage::Camera front_camera() {
    stage::Camera camera;
    camera.world_from_camera[3] = {0, 0, 2, 1};
    camera.fx = camera.fy = 64;
    camera.cx = 30;
    camera.cy = 34;
    camera.width = camera.height = kSide;
    return camera;
}

// An unlit rectangle at depth z that faces +Z; colours and UVs by corner, counter-clockwise from the lower left.
struct Quad {
    float x0 = -0.5f, x1 = 0.25f, y0 = -0.25f, y1 = 0.5f, z = 0;
    std::vector<float> colours = std::vector<float>(16, 1.0f);
    json material = {{"extensions", {{"KHR_materials_unlit", json::object()}}}};
};

GlbBuilder scene_of(const std::vector<Quad>& quads) {
    GlbBuilder glb;
    json primitives = json::array();
    for (size_t i = 0; i < quads.size(); ++i) {
        const Quad& q = quads[i];
        primitives.push_back(
            {{"attributes",
              {{"POSITION", glb.vec3({q.x0, q.y0, q.z, q.x1, q.y0, q.z, q.x1, q.y1, q.z, q.x0, q.y1, q.z})},
               {"TEXCOORD_0", glb.floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2)},
               {"COLOR_0", glb.vec4(q.colours)}}},
             {"indices", glb.add(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}, test::kU16, "SCALAR", 1)},
             {"material", i}});
        glb.root["materials"].push_back(q.material);
    }
    glb.root["meshes"] = {{{"primitives", primitives}}};
    glb.root["nodes"] = {{{"mesh", 0}}};
    return glb;
}

std::vector<glm::vec4> render(const GlbBuilder& glb, const stage::Camera& camera = front_camera()) {
    const TemporaryFolder folder;
    const stage::GltfScene scene = stage::load_gltf(folder.write(glb.bytes()));
    render::Rasterizer rasterizer(device(), scene, camera.width, camera.height);
    rasterizer.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    auto pixels = render::box_down(rasterizer.draw(camera, 0.01), camera.width, camera.height);
    EXPECT_EQ(device().drain_validation_messages(), std::vector<std::string>());
    return pixels;
}

glm::vec4 at(const std::vector<glm::vec4>& pixels, uint32_t x, uint32_t y) {
    return pixels[y * kSide + x];
}

void expect_near(const glm::vec4& a, const glm::vec4& b, float tolerance, const std::string& what = "") {
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << what << " channel " << c;
}

TEST(Raster, AQuadCoversExactlyItsPixels) {
    Quad quad;  // red increases to the right, green upwards
    quad.colours = {0, 0, 0.5f, 1, 1, 0, 0.5f, 1, 1, 1, 0.5f, 1, 0, 1, 0.5f, 1};
    const auto pixels = render(scene_of({quad}));
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            // x: 30 + 32·(−0.5 … 0.25); y: 34 − 32·(0.5 … −0.25), downwards.
            const bool inside = x >= 14 && x < 38 && y >= 18 && y < 42;
            const float red = (static_cast<float>(x) + 0.5f - 14) / 24,
                        green = 1 - (static_cast<float>(y) + 0.5f - 18) / 24;
            // The colour changes by 0.042 a pixel; along edges of triangles the shaded point moves by a sample.
            expect_near(at(pixels, x, y), inside ? glm::vec4(red, green, 0.5f, 1) : glm::vec4(0), 4e-3f,
                        std::to_string(x) + "," + std::to_string(y));
            if (HasFailure()) return;
        }
}

TEST(Raster, EdgesAreCoverageAndPremultiplied) {
    Quad quad;
    quad.x1 += 0.5f / 32;  // half a pixel
    quad.y0 -= 0.25f / 32;
    const auto pixels = render(scene_of({quad}));
    EXPECT_NEAR(at(pixels, 38, 30).a, 0.5, 0.01);
    EXPECT_NEAR(at(pixels, 20, 42).a, 0.25, 0.13);
    expect_near(at(pixels, 38, 30), glm::vec4(at(pixels, 38, 30).a), 1e-3f);
    const media::Image image = render::encode_straight(pixels, kSide, kSide);
    EXPECT_EQ(image.at(38, 30)[0], 255) << "white, however thin";
    EXPECT_NEAR(image.at(38, 30)[3], 128, 3);
}

TEST(Raster, CameraPoseIsOpenGl) {
    stage::Camera camera = front_camera();
    camera.world_from_camera = glm::dmat4(0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 1);  // a quarter roll
    Quad quad;
    quad.x0 = 0.25f;
    quad.x1 = 0.5f;
    quad.y0 = 0;
    quad.y1 = 0.5f;
    const auto pixels = render(scene_of({quad}), camera);
    // World x is the camera's −y (down in the image), world y its +x.
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x)
            ASSERT_NEAR(at(pixels, x, y).a, x >= 30 && x < 46 && y >= 42 && y < 50 ? 1 : 0, 1e-3) << x << "," << y;
}

TEST(Raster, NearerHidesAndBacksAreCulled) {
    Quad red, blue, flipped;
    red.colours = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
    blue.colours = {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1};
    red.z = 0.1f;
    expect_near(at(render(scene_of({red, blue})), 20, 30), {1, 0, 0, 1}, 1e-3f);
    expect_near(at(render(scene_of({blue, red})), 20, 30), {1, 0, 0, 1}, 1e-3f);
    std::swap(flipped.x0, flipped.x1);
    expect_near(at(render(scene_of({flipped})), 20, 30), glm::vec4(0), 1e-6f);
    flipped.material["doubleSided"] = true;
    expect_near(at(render(scene_of({flipped})), 20, 30), glm::vec4(1), 1e-3f);
    GlbBuilder mirrored = scene_of({Quad()});
    mirrored.root["nodes"][0]["scale"] = {1, 1, -1};
    expect_near(at(render(mirrored), 20, 30), glm::vec4(0), 1e-6f);
    mirrored.root["nodes"][0]["scale"] = {1, -1, -1};
    expect_near(at(render(mirrored), 20, 45), glm::vec4(0), 1e-6f);
}

TEST(Raster, AlphaModes) {
    Quad behind, front;
    behind.z = -0.01f;
    behind.colours = {0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1, 0, 1};
    front.colours = {1, 1, 1, 0.25f, 1, 1, 1, 0.25f, 1, 1, 1, 0.25f, 1, 1, 1, 0.25f};
    expect_near(at(render(scene_of({front})), 20, 30), glm::vec4(1), 1e-3f, "opaque ignores alpha");
    front.material["alphaMode"] = "BLEND";
    expect_near(at(render(scene_of({front})), 20, 30), glm::vec4(0.25f), 1e-3f, "blend alone");
    expect_near(at(render(scene_of({front, behind})), 20, 30), {0.25f, 1, 0.25f, 1}, 1e-3f, "blend comes last");
    front.material["alphaMode"] = "MASK";
    expect_near(at(render(scene_of({front})), 20, 30), glm::vec4(0), 1e-6f, "below the cutoff");
    front.material["alphaCutoff"] = 0.2;
    expect_near(at(render(scene_of({front})), 20, 30), glm::vec4(1), 1e-3f, "above the cutoff");
}

TEST(Raster, TexturesAreSrgbFromTheTopLeft) {
    media::Image texels(2, 2);
    const uint8_t rgba[] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 128, 128, 128, 255};
    texels.rgba.assign(std::begin(rgba), std::end(rgba));
    const TemporaryFolder folder;
    media::write_png(folder.path / "texels.png", texels);
    const std::vector<uint8_t> png = read_file(folder.path / "texels.png");
    Quad quad;
    quad.material["pbrMetallicRoughness"] = {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {1, 1, 0.5, 1}}};
    GlbBuilder glb = scene_of({quad});
    glb.root["images"] = {{{"bufferView", glb.add_view(png.data(), png.size())}, {"mimeType", "image/png"}}};
    glb.root["samplers"] = {{{"magFilter", 9728}, {"minFilter", 9728}, {"wrapS", 33071}, {"wrapT", 33071}}};
    glb.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
    const auto pixels = render(glb);
    const auto grey = static_cast<float>(media::linear_from_srgb(128 / 255.0));
    expect_near(at(pixels, 16, 20), {1, 0, 0, 1}, 2e-3f, "top left");
    expect_near(at(pixels, 36, 20), {0, 1, 0, 1}, 2e-3f, "top right");
    expect_near(at(pixels, 16, 40), {0, 0, 0.5f, 1}, 2e-3f, "bottom left");
    expect_near(at(pixels, 36, 40), {grey, grey, grey / 2, 1}, 2e-3f, "bottom right");
}

TEST(Raster, MipLevelsAverageLight) {
    media::Image texels(3, 2);
    for (uint32_t x = 0; x < 2; ++x)
        for (uint32_t y = 0; y < 2; ++y)
            for (int c = 0; c < 4; ++c) texels.at(x, y)[c] = c == 3 || x == 0 ? 255 : 0;
    const auto levels = render::mip_levels(texels);
    ASSERT_EQ(levels.size(), 2u);
    ASSERT_EQ(levels[1].size(), 4u);
    EXPECT_EQ(levels[1][0], 188) << "half the light in sRGB";
    EXPECT_EQ(levels[1][3], 255);
}

TEST(Raster, MipLevelsOfNumbersAreMeans) {
    media::Image texels(2, 3);
    const uint8_t rgba[] = {10, 0, 255, 0, 20, 1, 255, 40, 30, 2, 255, 80, 41, 4, 254, 121, 0, 0, 0, 0, 0, 0, 0, 0};
    texels.rgba.assign(std::begin(rgba), std::end(rgba));
    const auto levels = render::mip_levels_of_numbers(texels);
    ASSERT_EQ(levels.size(), 2u);
    EXPECT_EQ(levels[1], (std::vector<uint8_t>{25, 2, 255, 60}))
        << "each channel alone, rounded; the last row left out";
}

TEST(Raster, BoxDownAveragesBlocks) {
    std::vector<uint16_t> halves(4 * render::kSupersample * render::kSupersample * 2, 0);
    halves[0] = voctree::half_from_float(1);  // only red, in one of the pixels of the first block
    halves[3] = voctree::half_from_float(1);
    const auto pixels = render::box_down({1, 0, 2, 1, halves}, 4, 1);
    const float share = 1.0f / (render::kSupersample * render::kSupersample);
    for (size_t i = 0; i < 4; ++i) expect_near(pixels[i], i == 1 ? glm::vec4(share, 0, 0, share) : glm::vec4(0), 1e-6f);
}

}  // namespace
}  // namespace neuvv
