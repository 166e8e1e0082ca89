// The raster of the set against double precision: lights, depth, alpha, poses.
#include "render/set/set_raster.h"
#include "gpu/host_copies.h"

#include "render/set_truth.h"
#include "support/gpu_test.h"

namespace neuvv::test {
namespace {

using SetRasterTest = GpuTest;

TEST_F(SetRasterTest, APlaneUnderEachKindOfLight) {
    render::SetLight ranged = point();
    ranged.range_m = 1.4;
    const std::pair<const char*, std::vector<render::SetLight>> cases[] = {
        {"directional", {directional()}},
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
    // The flat triangles of the mesh are at most 3e-5 of the radius below the ball; the error is larger at grazing
    // angles.
    EXPECT_LT(agreement.worst, 1e-2);
    EXPECT_LT(agreement.depth, 5e-4);
    EXPECT_EQ(agreement.wrong_cover, 0u);
    EXPECT_GT(agreement.covered, 400u);
}

TEST_F(SetRasterTest, TheComparisonNoticesOtherLightsAndMaterials) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.7));
    const Lighting lighting{{spot()}, {}};
    const SetImages drawn = draw(device(), glb, camera_above(), lighting);
    const PbrMaterial material{{0.8, 0.5, 0.2}, 0, 0.7};
    ASSERT_LT(compare(drawn, camera_above(), floor_of(1.5), material, lighting).worst, kColourTolerance);
    Lighting other = lighting;
    other.lights[0].inner_cos = std::cos(0.21);
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.5), material, other).worst, kColourTolerance);
    PbrMaterial rougher = material;
    rougher.roughness = 0.72;
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.5), rougher, lighting).worst, kColourTolerance);
    EXPECT_GT(compare(drawn, camera_above(), floor_of(1.4), material, lighting).wrong_cover, 0u);
    stage::Camera nearer = camera_above();
    nearer.world_from_camera[3] *= 0.9999;
    EXPECT_GT(compare(drawn, nearer, floor_of(1.5), material, lighting).depth, kDepthTolerance);
}

TEST_F(SetRasterTest, ViewsStandBehindEachOther) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.7));
    const stage::GltfScene scene = scene_of(glb);
    const Lighting lighting{{spot()}, {}};
    const stage::Camera other = look_at({-0.7, 0.9, 1.8}, {0.2, 0, 0}, kSide, kSide, 0.9);
    render::SetRaster set(device(), scene, kSide, kSide, 3);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    set.lighting.light(lighting.lights, lighting.ambient);
    const SetImages drawn = draw_set(device(), set, {camera_above(), other});
    const PbrMaterial material{{0.8, 0.5, 0.2}, 0, 0.7};
    EXPECT_LT(compare(drawn, camera_above(), floor_of(1.5), material, lighting).worst, kColourTolerance);
    EXPECT_LT(compare(drawn, other, floor_of(1.5), material, lighting, kSide * kSide).worst, kColourTolerance);
    EXPECT_EQ(drawn.depth_m[2 * kSide * kSide + 77], INFINITY) << "the view without a camera";

    const stage::Camera small = look_at({0.4, 1.3, 2.2}, {0, 0, 0}, 32, 40, 1.1);
    const stage::Camera small_too = look_at({-0.7, 0.9, 1.8}, {0.2, 0, 0}, 32, 40, 0.9);
    const SetImages smaller = draw_set(device(), set, {small, small_too});
    EXPECT_LT(compare(smaller, small, floor_of(1.5), material, lighting).worst, kColourTolerance);
    const Agreement second = compare(smaller, small_too, floor_of(1.5), material, lighting, 32 * 40);
    EXPECT_LT(second.worst, kColourTolerance);
    EXPECT_LT(second.depth, kDepthTolerance);
    EXPECT_EQ(second.wrong_cover, 0u);
}

TEST_F(SetRasterTest, WhiteInUniformLightStaysWhite) {
    for (const double roughness : {0.0, 0.3, 1.0})
        for (const bool by_image : {false, true}) {
            GlbBuilder glb;
            add_mesh(glb, sphere({0, 0.2f, 0}, 0.7f, 64), pbr_material(glm::vec4(1), 0, roughness));
            const stage::GltfScene scene = scene_of(glb);
            const media::Image white = one_colour(255, 255, 255);
            render::SetRaster set(device(), scene, kSide, kSide, 1, by_image ? &white : nullptr);
            set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
            render::SetAmbient ambient;
            ambient.light = glm::dvec3(by_image ? 0 : 1);
            set.lighting.light({}, ambient);
            const SetImages drawn = draw_set(device(), set, {camera_above()});
            size_t covered = 0;
            for (const glm::dvec4& light : drawn.colour) {
                if (light.a == 0) continue;
                ++covered;
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(light[c], 1, 2e-3) << roughness << " " << by_image;
            }
            EXPECT_GT(covered, 400u);
        }
}

// The texel that shows a point of the world.
size_t texel_of(const stage::Camera& camera, const glm::dvec3& position) {
    const glm::dvec3 p(glm::inverse(camera.world_from_camera) * glm::dvec4(position, 1));
    return static_cast<size_t>(camera.cy + camera.fy * p.y / p.z) * camera.width +
           static_cast<size_t>(camera.cx - camera.fx * p.x / p.z);
}

json unlit(glm::vec4 base, const std::string& alpha_mode = "OPAQUE") {
    json material = pbr_material(base, 0, 1);
    material["extensions"] = {{"KHR_materials_unlit", json::object()}};
    material["alphaMode"] = alpha_mode;
    return material;
}

void expect_colour(const glm::dvec4& drawn, const glm::dvec4& wanted, const std::string& what = "") {
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(drawn[c], wanted[c], 1e-3) << what << ", channel " << c;
}

TEST_F(SetRasterTest, AlphaModesAndSides) {
    const stage::Camera camera = camera_above();
    const size_t centre = texel_of(camera, {0, 0, 0});
    const auto shows = [&](const json& material, bool turned_away = false) {
        GlbBuilder glb;
        json& node = add_mesh(glb, floor_mesh(), material);
        if (turned_away) node["rotation"] = {1, 0, 0, 0};
        return draw(device(), glb, camera, {}).colour[centre];
    };
    expect_colour(shows(unlit({0.5f, 0.25f, 1, 0.25f})), {0.5, 0.25, 1, 1}, "opaque");
    expect_colour(shows(unlit({0.5f, 0.25f, 1, 0.25f}, "BLEND")), {0.125, 0.0625, 0.25, 0.25}, "blend");
    json masked = unlit({0.5f, 0.25f, 1, 0.25f}, "MASK");
    expect_colour(shows(masked), glm::dvec4(0), "below the cutoff");
    masked["alphaCutoff"] = 0.2;
    expect_colour(shows(masked), {0.5, 0.25, 1, 1}, "above the cutoff");
    json sides = unlit({0.5f, 0.25f, 1, 1});
    expect_colour(shows(sides, true), glm::dvec4(0), "a back");
    sides["doubleSided"] = true;
    expect_colour(shows(sides, true), {0.5, 0.25, 1, 1}, "a back of both sides");
}

TEST_F(SetRasterTest, BacksAndMirrorsAreLitFromTheirSide) {
    const PbrMaterial material{{0.8, 0.5, 0.2}, 0.3, 0.6};
    const Lighting lighting{{spot(), point()}, {}};
    for (const bool mirrored : {false, true}) {
        GlbBuilder glb;
        json pbr = pbr_material({0.8f, 0.5f, 0.2f, 1}, 0.3, 0.6);
        pbr["doubleSided"] = !mirrored;
        json& node = add_mesh(glb, floor_mesh(), pbr);
        if (mirrored) {
            node["scale"] = {-1, 1, 1};
        } else {
            node["rotation"] = {1, 0, 0, 0};
        }
        const Agreement agreement =
            compare(draw(device(), glb, camera_above(), lighting), camera_above(), floor_of(1.5), material, lighting);
        EXPECT_LT(agreement.worst, kColourTolerance) << mirrored;
        EXPECT_EQ(agreement.wrong_cover, 0u) << mirrored;
    }
}

// A floor that a morph target and a joint lift; in both cases by half a metre in the end.
TEST_F(SetRasterTest, MorphsAndSkinsMoveWhatIsDrawn) {
    for (const bool skinned : {false, true}) {
        GlbBuilder glb;
        MeshData mesh = floor_mesh();
        json& node = add_mesh(glb, mesh, pbr_material({0.8f, 0.5f, 0.2f, 1}, 0, 0.7));
        node["translation"] = {0, skinned ? 7 : -0.5, 0};  // the node of a skinned mesh has no effect
        json& primitive = glb.root["meshes"][0]["primitives"][0];
        if (skinned) {
            primitive["attributes"]["JOINTS_0"] = glb.add(std::vector<uint8_t>(16, 0), kU8, "VEC4", 4);
            std::vector<float> weights(16, 0);
            for (size_t i = 0; i < 16; i += 4) weights[i] = 1;
            primitive["attributes"]["WEIGHTS_0"] = glb.vec4(weights);
            glb.root["nodes"].push_back({{"translation", {0, 0, 0}}});
            glb.root["skins"] = {
                {{"joints", {1}},
                 {"inverseBindMatrices", glb.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", 16)}}};
            glb.root["nodes"][0]["skin"] = 0;
        } else {
            primitive["targets"] = {{{"POSITION", glb.vec3({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0})}}};
            glb.root["nodes"][0]["weights"] = {0.0};
        }
        const stage::GltfScene scene = scene_of(glb);
        render::SetRaster set(device(), scene, kSide, kSide, 1);
        stage::PosedScene pose = stage::pose_scene(scene, stage::kNoAnimation, 0);
        if (!skinned) pose.morph_weights[0][0] = 0.5f;
        set.pose(pose);
        const PbrMaterial material{{0.8, 0.5, 0.2}, 0, 0.7};
        const Lighting lighting{{spot()}, {}};
        set.lighting.light(lighting.lights, lighting.ambient);
        const Agreement still =
            compare(draw_set(device(), set, {camera_above()}), camera_above(), floor_of(1.5), material, lighting);
        EXPECT_LT(still.worst, kColourTolerance) << skinned;
        EXPECT_EQ(still.wrong_cover, 0u) << skinned;
        if (skinned) {
            pose.joint_matrices[0][0][3].y = 0.3;
        } else {
            pose.morph_weights[0][0] = 0.8f;
        }
        set.pose(pose);
        const SetImages moved = draw_set(device(), set, {camera_above()});
        const Surface lifted = [](const reference::Ray& ray) -> std::optional<Hit> {
            reference::Ray lower = ray;
            lower.origin.y -= 0.3;
            auto hit = floor_of(1.5)(lower);
            if (hit) hit->position.y += 0.3;
            return hit;
        };
        const Agreement after = compare(moved, camera_above(), lifted, material, lighting);
        EXPECT_LT(after.worst, kColourTolerance) << skinned;
        EXPECT_LT(after.depth, kDepthTolerance) << skinned;
        EXPECT_EQ(after.wrong_cover, 0u) << skinned;
    }
}

TEST_F(SetRasterTest, ASceneWithoutMeshesShowsNothing) {
    GlbBuilder glb;
    glb.root["nodes"] = {{{"name", "nothing"}}};
    Lighting lighting{{directional(), spot()}, {}};
    for (render::SetLight& light : lighting.lights) light.casts_shadow = true;
    const SetImages drawn = draw(device(), glb, camera_above(), lighting);
    for (size_t i = 0; i < drawn.depth_m.size(); ++i) {
        ASSERT_EQ(drawn.colour[i], glm::dvec4(0));
        ASSERT_EQ(drawn.depth_m[i], INFINITY);
    }
}

// Vertices that are finite in the file, but not once they are posed: the rest must still be drawn.
TEST_F(SetRasterTest, VerticesThatOverflowHurtNobody) {
    GlbBuilder glb;
    MeshData far = floor_mesh();
    for (float& coordinate : far.positions) coordinate *= 1e30f;
    json& huge = add_mesh(glb, far, unlit({1, 0, 0, 1}));
    huge["scale"] = {1e11, 1e11, 1e11};
    add_mesh(glb, rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), unlit({0, 1, 0, 1}));
    Lighting lighting{{directional()}, {}};
    lighting.lights[0].casts_shadow = true;
    const SetImages drawn = draw(device(), glb, camera_above(), lighting);
    expect_colour(drawn.colour[texel_of(camera_above(), {0, 0.5, 0})], {0, 1, 0, 1});
}

TEST_F(SetRasterTest, NearerHides) {
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), unlit({1, 0, 0, 1}));
    add_mesh(glb, sphere({0, 0, 0}, 0.5f, 32), unlit({0, 1, 0, 1}));
    const stage::Camera camera = camera_above();
    const SetImages drawn = draw(device(), glb, camera, {});
    expect_colour(drawn.colour[texel_of(camera, {0, 0.3, 0})], {0, 1, 0, 1}, "the ball before the floor");
    expect_colour(drawn.colour[texel_of(camera, {-0.9, 0, 0.5})], {1, 0, 0, 1}, "the floor beside it");
}

// Panes of half alpha at z = 0.3 (red), 0 (green) and −0.3 (blue) before a white wall, not in this order in the file.
TEST_F(SetRasterTest, PanesAreBlendedFarToNearInTwoLayers) {
    GlbBuilder glb;
    const auto pane = [&](float z, glm::vec3 colour) {
        add_mesh(glb, rectangle({-2, -2, z}, {4, 0, 0}, {0, 4, 0}), unlit(glm::vec4(colour, 0.5f), "BLEND"));
    };
    pane(0, {0, 1, 0});
    pane(0.3f, {1, 0, 0});
    pane(-1.5f, {1, 0, 1});  // behind the wall
    pane(-0.3f, {0, 0, 1});
    add_mesh(glb, rectangle({-4, -4, -1}, {8, 0, 0}, {0, 8, 0}), unlit(glm::vec4(1)));
    const stage::GltfScene scene = scene_of(glb);
    const stage::Camera camera = look_at({0, 0, 2}, {0, 0, 0}, kSide, kSide, 1);
    render::SetRaster set(device(), scene, kSide, kSide, 1);
    EXPECT_TRUE(set.has_transparent());
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    // Left: no volume. Right: a volume between red and green.
    std::vector<float> volume(kSide * kSide, INFINITY);
    for (size_t i = 0; i < volume.size(); ++i)
        if (i % kSide >= kSide / 2) volume[i] = 1.85f;
    gpu::upload(device(), set.targets().volume_depth, volume.data(), volume.size() * sizeof(float));
    const SetImages drawn = draw_set(device(), set, {camera});
    const glm::dvec4 blue = 0.5 * glm::dvec4(0, 0, 1, 1) + 0.5 * glm::dvec4(1);
    const glm::dvec4 green = 0.5 * glm::dvec4(0, 1, 0, 1) + 0.5 * blue;
    const glm::dvec4 red = 0.5 * glm::dvec4(1, 0, 0, 1);
    for (size_t i = 0; i < volume.size(); ++i) {
        const bool left = i % kSide < kSide / 2;
        expect_colour(drawn.colour[i], left ? red + 0.5 * green : green, "over the wall");
        expect_colour(drawn.front[i], left ? glm::dvec4(0) : red, "before the volume");
        ASSERT_NEAR(drawn.depth_m[i], 3, 1e-5) << "panes leave no depth";
        if (HasFailure()) return;
    }
    // From behind, panes and wall are culled, as they have one side.
    const SetImages behind = draw_set(device(), set, {look_at({0, 0, -4}, {0, 0, 0}, kSide, kSide, 1)});
    expect_colour(behind.colour[kSide * 10 + 10], glm::dvec4(0), "from behind");
}

TEST_F(SetRasterTest, NothingStaysOfPanesThatAreNotDrawnAnyMore) {
    GlbBuilder glass, wall;
    add_mesh(glass, rectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), unlit({1, 0, 0, 0.5f}, "BLEND"));
    add_mesh(wall, rectangle({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), unlit({1, 0, 0, 1}));
    const stage::GltfScene pane = scene_of(glass), opaque = scene_of(wall);
    const stage::Camera camera = look_at({0, 0, 2}, {0, 0, 0}, kSide, kSide, 1);
    const auto environment = std::make_shared<render::SetEnvironment>(device(), nullptr);
    render::SetRaster set(device(), pane, kSide, kSide, 1, environment);
    set.pose(stage::pose_scene(pane, stage::kNoAnimation, 0));
    std::vector<float> behind_it(kSide * kSide, 2.5f);
    gpu::upload(device(), set.targets().volume_depth, behind_it.data(), behind_it.size() * sizeof(float));
    const size_t centre = kSide * kSide / 2 + kSide / 2;
    const auto front = [&] { return draw_set(device(), set, {camera}).front[centre]; };
    expect_colour(front(), {0.5, 0, 0, 0.5}, "a pane before the volume");
    set.catch_shadows(-1.0);
    expect_colour(front(), glm::dvec4(0), "where only shadows are drawn");
    set.catch_shadows({});
    expect_colour(front(), {0.5, 0, 0, 0.5}, "it is back");
    set.change(opaque, environment);
    set.pose(stage::pose_scene(opaque, stage::kNoAnimation, 0));
    expect_colour(front(), glm::dvec4(0), "in a scene without panes");
}

}  // namespace
}  // namespace neuvv::test
