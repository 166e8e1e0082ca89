// The textures of glTF materials other than the base colour, on a floor, against double precision.
#include "render/set/set_raster.h"
#include "render/set_truth.h"
#include "support/gpu_test.h"

namespace neuvv::test::set_material_test {
namespace {

using SetMaterialTest = GpuTest;

const PbrMaterial kMaterial{{0.8, 0.5, 0.2}, 0.2, 0.6};

// A floor whose material uses this texture as `map`, an object of the material's JSON.
struct MappedFloor {
    GlbBuilder glb;
    json* material = nullptr;

    explicit MappedFloor(const media::Image& image) {
        add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0.2, 0.6));
        add_texture(glb, image);
        material = &glb.root["materials"][0];
    }
};

Agreement agreement_of(const gpu::Device& device, const GlbBuilder& glb, const Lighting& lighting,
                       const PbrMaterial& material = kMaterial, glm::dvec3 normal = {0, 1, 0},
                       const stage::Camera& camera = camera_above()) {
    const Agreement agreement =
        compare(draw(device, glb, camera, lighting), camera, floor_of(1.5, normal), material, lighting);
    EXPECT_GT(agreement.covered, 800u);
    EXPECT_EQ(agreement.wrong_cover, 0u);
    return agreement;
}

Lighting usual_lighting() {
    Lighting lighting{{spot(), point()}, {}};
    lighting.ambient.light = {0.2, 0.3, 0.1};
    return lighting;
}

// U of the floor increases along +X and V along +Z, so the axes of normal maps are +X and −Z.
constexpr uint8_t kTilt[3] = {204, 100, 228};
glm::dvec3 tilted(glm::dvec3 t, glm::dvec3 b, glm::dvec3 n, double scale = 1) {
    const glm::dvec3 local = glm::dvec3(kTilt[0], kTilt[1], kTilt[2]) / 255.0 * 2.0 - 1.0;
    return glm::normalize(scale * local.x * t + scale * local.y * b + local.z * n);
}
const glm::dvec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

TEST_F(SetMaterialTest, NormalMapsTiltByTheTangents) {
    struct Case {
        const char* name;
        std::function<void(MappedFloor&)> change;
        glm::dvec3 normal;
    };
    const auto transform = [](const json& members) {
        return [members](MappedFloor& floor) {
            (*floor.material)["normalTexture"]["extensions"] = {{"KHR_texture_transform", members}};
        };
    };
    const Case cases[] = {
        {"as it is", [](MappedFloor&) {}, tilted(kX, -kZ, kY)},
        {"scaled", [](MappedFloor& f) { (*f.material)["normalTexture"]["scale"] = 0.4; }, tilted(kX, -kZ, kY, 0.4)},
        {"rotated UVs", transform({{"rotation", std::numbers::pi / 2}}), tilted(kZ, kX, kY)},
        {"mirrored UVs", transform({{"scale", {-1, 1}}}), tilted(-kX, -kZ, kY)},
        {"mirrored node",
         [](MappedFloor& f) {
             f.glb.root["nodes"][0]["scale"] = {-1, 1, 1};
         },
         tilted(-kX, -kZ, kY)},
        {"the file's tangents",
         [](MappedFloor& f) {
             std::vector<float> tangents;
             for (int i = 0; i < 4; ++i) tangents.insert(tangents.end(), {0, 0, -1, -1});
             f.glb.root["meshes"][0]["primitives"][0]["attributes"]["TANGENT"] = f.glb.vec4(tangents);
         },
         tilted(-kZ, kX, kY)},
        {"the back of both sides",
         [](MappedFloor& f) {
             (*f.material)["doubleSided"] = true;
             f.glb.root["nodes"][0]["rotation"] = {1, 0, 0, 0};  // half a turn about X: T, B, N are +X, +Z, −Y
         },
         -tilted(kX, kZ, -kY)},
    };
    for (const Case& one : cases) {
        MappedFloor floor(one_colour(kTilt[0], kTilt[1], kTilt[2]));
        (*floor.material)["normalTexture"] = {{"index", 0}};
        one.change(floor);
        EXPECT_LT(agreement_of(device(), floor.glb, usual_lighting(), kMaterial, one.normal).worst, kColourTolerance)
            << one.name;
        EXPECT_GT(agreement_of(device(), floor.glb, usual_lighting()).worst, 0.1) << one.name << ": no tilt at all";
    }
}

TEST_F(SetMaterialTest, ANormalMapWithoutUvsDoesNothing) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0.2, 0.6), false);
    add_texture(glb, one_colour(255, 128, 128));
    glb.root["materials"][0]["normalTexture"] = {{"index", 0}};
    EXPECT_LT(agreement_of(device(), glb, usual_lighting()).worst, kColourTolerance);
}

TEST_F(SetMaterialTest, MetalAndRoughnessAreNumbersInBlueAndGreen) {
    MappedFloor floor(one_colour(7, 128, 200));
    (*floor.material)["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {{"index", 0}};
    PbrMaterial material = kMaterial;
    material.metallic *= 200 / 255.0;
    material.roughness *= 128 / 255.0;
    EXPECT_LT(agreement_of(device(), floor.glb, usual_lighting(), material).worst, kColourTolerance);
    EXPECT_GT(agreement_of(device(), floor.glb, usual_lighting()).worst, 0.1);
}

TEST_F(SetMaterialTest, OcclusionTakesLightFromAroundAlone) {
    MappedFloor floor(one_colour(64, 255, 255));
    (*floor.material)["occlusionTexture"] = {{"index", 0}, {"strength", 0.6}};
    Lighting lighting = usual_lighting();
    lighting.occlusion = 1 + 0.6 * (64 / 255.0 - 1);
    EXPECT_LT(agreement_of(device(), floor.glb, lighting).worst, kColourTolerance);
}

TEST_F(SetMaterialTest, EmissionIsSrgbTimesFactorAndStrength) {
    MappedFloor floor(one_colour(200, 100, 255));
    (*floor.material)["emissiveTexture"] = {{"index", 0}};
    (*floor.material)["emissiveFactor"] = {0.5, 1, 0.25};
    (*floor.material)["extensions"] = {{"KHR_materials_emissive_strength", {{"emissiveStrength", 3}}}};
    Lighting lighting = usual_lighting();
    lighting.emitted =
        3.0 * glm::dvec3(0.5 * media::linear_from_srgb(200 / 255.0), media::linear_from_srgb(100 / 255.0), 0.25);
    // Devices decode sRGB to half a step of 8 bits at best: 0.5 % here.
    EXPECT_LT(agreement_of(device(), floor.glb, lighting).worst, 5e-3);
}

TEST_F(SetMaterialTest, EachTextureHasItsUvSet) {
    media::Image halves = one_colour(0, 0, 0);
    for (uint32_t y = 0; y < 4; ++y)
        for (int c = 0; c < 3; ++c) halves.at(3, y)[c] = 255;  // one white column; the rest is black
    MappedFloor floor(halves);
    std::vector<float> uvs;
    for (int i = 0; i < 4; ++i) uvs.insert(uvs.end(), {0.875f, 0.375f});  // the centre of a texel of that column
    floor.glb.root["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = floor.glb.floats(uvs, "VEC2", 2);
    (*floor.material)["emissiveTexture"] = {{"index", 0}, {"texCoord", 1}};
    (*floor.material)["emissiveFactor"] = {1, 0.5, 0.25};
    Lighting lighting = usual_lighting();
    lighting.emitted = {1, 0.5, 0.25};
    EXPECT_LT(agreement_of(device(), floor.glb, lighting).worst, kColourTolerance);
}

}  // namespace
}  // namespace neuvv::test::set_material_test
