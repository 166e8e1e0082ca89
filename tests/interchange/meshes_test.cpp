// Meshes with colours: the atlas, what is baked, images of them, the loss that is said, and files read back.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <sstream>

#include "base/platform.h"
#include "interchange/mesh/bake.h"
#include "interchange/mesh/clip_mesh.h"
#include "interchange/mesh/mesh_files.h"
#include "interchange/mesh/mesh_gltf.h"
#include "interchange/mesh/mesh_loss.h"
#include "interchange/mesh/surface_net.h"
#include "stage/gltf/gltf_scene.h"
#include "support/closed_mesh.h"
#include "support/look_at.h"
#include "support/temporary_folder.h"

namespace neuvv::test {
namespace {

using interchange::ColouredMesh;
using interchange::MappedMesh;
using interchange::TriangleMesh;

constexpr float kRadius = 0.4f, kCell = 1.0f / 32;
const glm::vec3 kCentre(0.5f);
constexpr uint32_t kSide = 128;

float logit(float linear) {
    return std::log(linear / (1 - linear)) / 0.28209479f;
}

// Opaque, red where x is more than ½, green elsewhere.
slice::Slice two_colours() {
    slice::Slice volume = volume_of(5, 1e4f, [](const glm::vec3& p) { return glm::distance(p, kCentre) < kRadius; });
    for (slice::Leaf& leaf : volume.leaves) {
        const bool red = volume.centre_m(leaf).x > 0.5f;
        leaf.colours[0][0] = logit(red ? 0.8f : 0.05f);
        leaf.colours[1][0] = logit(red ? 0.05f : 0.6f);
        leaf.colours[2][0] = logit(0.1f);
    }
    return volume;
}

ColouredMesh textured() {
    return *interchange::clip_mesh(two_colours(), {0.5, 1500, 0, kSide}, [](std::string_view) {});
}

// A camera on +x that looks at the ball's centre from 3 m, or one on −x.
stage::Camera camera_at(double x) {
    stage::Camera camera = look_at({x, 0.5, 0.5}, {0.5, 0.5, 0.5}, 1, 1);
    camera.width = camera.height = 96;
    camera.fx = camera.fy = 200;
    camera.cx = camera.cy = 48;
    return camera;
}

bool is_inside(const std::array<glm::vec2, 3>& corners, const glm::vec2& p) {
    for (size_t k = 0; k < 3; ++k) {
        const glm::vec2 edge = corners[(k + 1) % 3] - corners[k], to = p - corners[k];
        if (!(edge.x * to.y - edge.y * to.x > 0)) return false;
    }
    return true;
}

// A rough surface, whose charts would overlap where they are not divided.
TEST(Atlas, HasNoOverlapsAndKeepsChartsApart) {
    constexpr int kPixels = 512;
    const slice::Slice volume = volume_of(5, 1e4f, [](const glm::vec3& p) {
        const glm::vec2 at(p.x - 0.5f, p.z - 0.5f);
        const float turn = std::atan2(at.y, at.x) / 6.2831853f + p.y * 2;  // a screw
        return glm::length(at) < 0.12f || (glm::length(at) < 0.4f && std::abs(turn - std::round(turn)) < 0.2f);
    });
    const TriangleMesh surface = interchange::surface_of(interchange::solid_of(interchange::LeafGrid(volume), 0.5));
    const std::optional<MappedMesh> mesh = interchange::mapped(surface, kPixels);
    ASSERT_TRUE(mesh.has_value());
    ASSERT_EQ(mesh->triangles.size(), surface.triangles.size());
    // A chart is what shares vertices.
    std::vector<uint32_t> chart(mesh->positions.size());
    for (uint32_t i = 0; i < chart.size(); ++i) chart[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (const glm::uvec3& t : mesh->triangles) {
            const uint32_t least = std::min({chart[t.x], chart[t.y], chart[t.z]});
            for (int k = 0; k < 3; ++k) {
                changed |= chart[t[k]] != least;
                chart[t[k]] = least;
            }
        }
    }
    std::vector<uint32_t> of_texel(size_t{kPixels} * kPixels, UINT32_MAX);
    int twice = 0, covered = 0;
    for (const glm::uvec3& t : mesh->triangles) {
        std::array<glm::vec2, 3> corners;
        for (int k = 0; k < 3; ++k) {
            corners[static_cast<size_t>(k)] = static_cast<float>(kPixels) * mesh->uvs[t[k]];
            EXPECT_TRUE(glm::all(glm::greaterThan(mesh->uvs[t[k]], glm::vec2(0))));
            EXPECT_TRUE(glm::all(glm::lessThan(mesh->uvs[t[k]], glm::vec2(1))));
        }
        const glm::ivec2 low(glm::min(glm::min(corners[0], corners[1]), corners[2]));
        const glm::ivec2 high(glm::max(glm::max(corners[0], corners[1]), corners[2]));
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x) {
                if (!is_inside(corners, glm::vec2(x, y) + 0.5f)) continue;
                uint32_t& texel = of_texel[static_cast<size_t>(y * kPixels + x)];
                if (texel != UINT32_MAX) ++twice;
                texel = chart[t.x];
                ++covered;
            }
    }
    EXPECT_EQ(twice, 0);
    EXPECT_GT(covered, kPixels * kPixels / 4) << "the square is used";
    int close = 0;
    for (int y = 2; y + 2 < kPixels; ++y)
        for (int x = 2; x + 2 < kPixels; ++x)
            for (int i = 0; i < 25; ++i) {
                const uint32_t a = of_texel[static_cast<size_t>(y * kPixels + x)];
                const uint32_t b = of_texel[static_cast<size_t>((y + i / 5 - 2) * kPixels + x + i % 5 - 2)];
                if (a != UINT32_MAX && b != UINT32_MAX && a != b) ++close;
            }
    EXPECT_EQ(close, 0) << "two texels lie between charts";
    EXPECT_FALSE(interchange::mapped(surface, 8).has_value());
}

TEST(Bake, VerticesHaveTheColoursOfLeaves) {
    const interchange::LeafGrid grid(two_colours());
    const TriangleMesh mesh = interchange::surface_of(interchange::solid_of(grid, 0.5));
    const auto colours = interchange::vertex_colours(grid, mesh);
    ASSERT_EQ(colours.size(), mesh.positions.size());
    size_t seen = 0;
    for (size_t i = 0; i < colours.size(); ++i) {
        if (std::abs(mesh.positions[i].x - 0.5f) < kCell) continue;
        const bool red = mesh.positions[i].x > 0.5f;
        EXPECT_EQ(colours[i][0], media::srgb_byte_from_linear(red ? 0.8f : 0.05f));
        EXPECT_EQ(colours[i][1], media::srgb_byte_from_linear(red ? 0.05f : 0.6f));
        EXPECT_EQ(colours[i][2], media::srgb_byte_from_linear(0.1f));
        ++seen;
    }
    EXPECT_GT(seen, colours.size() * 3 / 4);
}

TEST(Bake, TexelsHaveTheColoursOfTheirPoints) {
    const ColouredMesh mesh = textured();
    EXPECT_EQ(mesh.texture.width, kSide);
    for (size_t i = 0; i < mesh.mesh.positions.size(); ++i) {
        const glm::vec3& p = mesh.mesh.positions[i];
        if (std::abs(p.x - 0.5f) < 3 * kCell) continue;
        const glm::uvec2 texel(mesh.mesh.uvs[i] * static_cast<float>(kSide));
        const uint8_t* rgba = mesh.texture.at(texel.x, texel.y);
        EXPECT_EQ(rgba[0], media::srgb_byte_from_linear(p.x > 0.5f ? 0.8f : 0.05f)) << p.x;
        EXPECT_EQ(rgba[3], 255);
    }
}

// The ball covers the circle that it should, at the distance at which it is, with its colours.
TEST(MeshImage, ShowsTheBall) {
    const ColouredMesh mesh = textured();
    for (const double x : {3.5, -2.5}) {
        const media::LinearImage image = interchange::mesh_image(mesh, camera_at(x), 2);
        const size_t centre = 48 * 96 + 48;
        EXPECT_NEAR(image.depth_m[centre], 3 - kRadius, 0.5 * double{kCell});
        EXPECT_NEAR(image.rgba[4 * centre], x > 0 ? 0.8 : 0.05, 0.01);
        EXPECT_NEAR(image.rgba[4 * centre + 1], x > 0 ? 0.05 : 0.6, 0.01);
        EXPECT_EQ(image.rgba[4 * centre + 3], 1);
        EXPECT_TRUE(std::isinf(image.depth_m[0]));
        double covered = 0;
        for (size_t i = 0; i < image.depth_m.size(); ++i) covered += double{image.rgba[4 * i + 3]};
        const double radius_px = 200 * double{kRadius} / std::sqrt(9 - double{kRadius * kRadius});
        EXPECT_NEAR(covered / (3.14159265 * radius_px * radius_px), 1, 0.04);
    }
}

// A black square that faces +x, seen from 3 m.
TEST(MeshLoss, SaysHowFarAMeshIs) {
    ColouredMesh mesh;
    for (const glm::vec2 corner : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}}) {
        mesh.mesh.positions.emplace_back(0.5f, 0.5f + 0.24f * corner.y, 0.5f - 0.24f * corner.x);
        mesh.mesh.normals.emplace_back(1, 0, 0);
        mesh.colours.push_back({0, 0, 0});
    }
    mesh.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    const std::vector<interchange::MeshView> views = {
        {camera_at(3.5), interchange::mesh_image(mesh, camera_at(3.5), 2)}};
    EXPECT_NEAR(views[0].image.depth_m[48 * 96 + 48], 3, 1e-4);
    const interchange::MeshLoss none = interchange::loss_of(mesh, views);
    EXPECT_EQ(none.iou, 1);
    EXPECT_EQ(none.depth_mean_mm, 0);
    EXPECT_EQ(none.depth_95_mm, 0);
    EXPECT_EQ(none.psnr_db, 99);
    const std::vector<glm::vec3> positions = mesh.mesh.positions;
    for (glm::vec3& p : mesh.mesh.positions) p.x -= 0.02f;
    const interchange::MeshLoss behind = interchange::loss_of(mesh, views);
    EXPECT_NEAR(behind.depth_mean_mm, 20, 0.2);
    EXPECT_NEAR(behind.depth_95_mm, 20, 0.3);
    mesh.mesh.positions = positions;
    for (glm::vec3& p : mesh.mesh.positions) p.y += 0.24f;  // half of its width, 16 of 32 pixels
    const interchange::MeshLoss aside = interchange::loss_of(mesh, views);
    EXPECT_NEAR(aside.iou, 1.0 / 3, 0.01);
    EXPECT_NEAR(aside.psnr_db, -10 * std::log10(32.0 * 32 / (96 * 96)), 0.1) << "as many pixels are wrong";
    EXPECT_LT(aside.depth_mean_mm, 1);
}

TEST(MeshFiles, GlbIsReadBackWithItsTexture) {
    const ColouredMesh mesh = textured();
    interchange::MeshGlb glb;
    glb.add(mesh);
    glb.add({});
    glb.add(mesh);
    const TemporaryFolder folder;
    glb.write(folder.path / "x.glb", 25);
    const stage::GltfScene scene = stage::load_gltf(folder.path / "x.glb");
    ASSERT_EQ(scene.meshes.size(), 2u);
    const stage::GltfPrimitive& primitive = scene.meshes[0].primitives[0];
    EXPECT_EQ(primitive.positions, mesh.mesh.positions);
    ASSERT_EQ(primitive.normals.size(), mesh.mesh.normals.size());
    for (size_t i = 0; i < primitive.normals.size(); ++i)
        EXPECT_LT(glm::distance(primitive.normals[i], mesh.mesh.normals[i]), 1e-6f);
    EXPECT_EQ(primitive.uvs, mesh.mesh.uvs);
    ASSERT_EQ(primitive.indices.size(), 3 * mesh.mesh.triangles.size());
    EXPECT_EQ(std::memcmp(primitive.indices.data(), mesh.mesh.triangles.data(), 4 * primitive.indices.size()), 0);
    const stage::GltfMaterial& material = scene.materials[static_cast<size_t>(primitive.material)];
    EXPECT_TRUE(material.unlit);
    const auto& image = scene.images[scene.textures[static_cast<size_t>(material.texture)].image];
    EXPECT_EQ(image->pixels.rgba, mesh.texture.rgba);
    ASSERT_EQ(scene.nodes.size(), 3u);
    EXPECT_EQ(scene.nodes[1].mesh, -1);
    EXPECT_EQ(scene.animations[0].channels.size(), 3u);
    EXPECT_DOUBLE_EQ(scene.animations[0].duration_s, static_cast<double>(3 / 25.0f));
}

TEST(MeshFiles, ObjIsReadBack) {
    const ColouredMesh mesh = textured();
    const TemporaryFolder folder;
    interchange::write_mesh_obj(folder.path / "a b.obj", mesh);
    std::istringstream lines(read_text(folder.path / "a b.obj"));
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec2> uvs;
    std::vector<glm::uvec3> triangles;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream in(line);
        std::string word;
        in >> word;
        glm::vec3 v(0);
        if (word == "v" && in >> v.x >> v.y >> v.z) positions.push_back(v);
        if (word == "vn" && in >> v.x >> v.y >> v.z) normals.push_back(v);
        if (word == "vt" && in >> v.x >> v.y) uvs.emplace_back(v.x, v.y);
        glm::uvec3 t(0);
        for (int k = 0; word == "f" && k < 3; ++k) {
            uint32_t uv = 0, normal = 0;
            char slash = 0;
            in >> t[k] >> slash >> uv >> slash >> normal;
            EXPECT_TRUE(uv == t[k] && normal == t[k] && slash == '/');
        }
        if (word == "f") triangles.push_back(t - 1u);
        if (word == "mtllib") {
            EXPECT_EQ(line, "mtllib a b.mtl");
        }
    }
    EXPECT_EQ(triangles, mesh.mesh.triangles);
    ASSERT_EQ(positions.size(), mesh.mesh.positions.size());
    ASSERT_EQ(uvs.size(), positions.size());
    ASSERT_EQ(normals.size(), positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        EXPECT_LT(glm::distance(positions[i], mesh.mesh.positions[i]), 1e-6f);
        EXPECT_LT(glm::distance(normals[i], mesh.mesh.normals[i]), 1e-3f);
        EXPECT_LT(glm::distance(uvs[i], glm::vec2(mesh.mesh.uvs[i].x, 1 - mesh.mesh.uvs[i].y)), 1e-5f);
    }
    EXPECT_NE(read_text(folder.path / "a b.mtl").find("map_Kd a b_texture.png\n"), std::string::npos);
    EXPECT_EQ(media::read_png(folder.path / "a b_texture.png").rgba, mesh.texture.rgba);
}

TEST(MeshFiles, StandInTheirCapture) {
    const ColouredMesh mesh = textured();
    const glm::dvec3 origin(512350.125, 410, -5403210.0625), expected = glm::dvec3(mesh.mesh.positions[0]) + origin;
    const TemporaryFolder folder;
    interchange::write_mesh_obj(folder.path / "x.obj", mesh, origin);
    const std::string text = read_text(folder.path / "x.obj");
    glm::dvec3 found(0);
    ASSERT_EQ(std::sscanf(text.substr(text.find("\nv ")).c_str(), "\nv %lf %lf %lf", &found.x, &found.y, &found.z), 3);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], 1e-6);

    const ColouredMesh coloured = *interchange::clip_mesh(two_colours(), {0.5, 0, 0, 0}, [](std::string_view) {});
    interchange::write_mesh_ply(folder.path / "x.ply", coloured, origin);
    const std::string ply = read_text(folder.path / "x.ply");
    EXPECT_NE(ply.find("property double x\nproperty double y\nproperty double z\nproperty float nx\n"),
              std::string::npos);
    std::memcpy(&found, &ply[ply.find("end_header\n") + 11], sizeof found);
    for (int axis = 0; axis < 3; ++axis)
        EXPECT_EQ(found[axis], double{coloured.mesh.positions[0][axis]} + origin[axis]);
}

TEST(MeshFiles, ObjMayBeEmpty) {
    const TemporaryFolder folder;
    interchange::write_mesh_obj(folder.path / "x.obj", ColouredMesh());
    const std::string text = read_text(folder.path / "x.obj");
    EXPECT_NE(text.find("mtllib x.mtl\n"), std::string::npos);
    EXPECT_EQ(text.find("\nf "), std::string::npos);
    EXPECT_EQ(media::read_png(folder.path / "x_texture.png").width, 1u);
}

TEST(MeshFiles, PlyIsReadBack) {
    const ColouredMesh mesh = *interchange::clip_mesh(two_colours(), {0.5, 0, 0, 0}, [](std::string_view) {});
    ASSERT_EQ(mesh.colours.size(), mesh.mesh.positions.size());
    const TemporaryFolder folder;
    interchange::write_mesh_ply(folder.path / "x.ply", mesh);
    const std::vector<uint8_t> bytes = read_file(folder.path / "x.ply");
    const std::string text(bytes.begin(), bytes.end());
    const size_t count = mesh.mesh.positions.size(), faces = mesh.mesh.triangles.size();
    for (const std::string& part :
         {"element vertex " + std::to_string(count), "element face " + std::to_string(faces),
          std::string("property list uchar int vertex_indices"), std::string("property uchar blue")})
        EXPECT_NE(text.find(part + "\n"), std::string::npos) << part;
    const size_t data = text.find("end_header\n") + 11;
    ASSERT_EQ(bytes.size(), data + 27 * count + 13 * faces);
    for (size_t i = 0; i < count; ++i) {
        glm::vec3 position;
        std::memcpy(&position, &bytes[data + 27 * i], sizeof position);
        EXPECT_EQ(position, mesh.mesh.positions[i]);
        EXPECT_EQ(std::memcmp(&bytes[data + 27 * i + 24], mesh.colours[i].data(), 3), 0);
    }
    for (size_t i = 0; i < faces; ++i) {
        const uint8_t* face = &bytes[data + 27 * count + 13 * i];
        EXPECT_EQ(face[0], 3);
        EXPECT_EQ(std::memcmp(face + 1, &mesh.mesh.triangles[i], 12), 0);
    }
}

}  // namespace
}  // namespace neuvv::test
