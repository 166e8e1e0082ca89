// Builds sets for tests, and draws them with SetRaster.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "base/platform.h"
#include "gpu/host_copies.h"
#include "media/image.h"
#include "render/set/set_raster.h"
#include "tests/stage/glb_builder.h"
#include "voctree/files/half.h"

namespace neuvv::test {

struct MeshData {
    std::vector<float> positions, normals, uvs;
    std::vector<uint32_t> indices;
};

// A rectangle from `corner` along u and v. Seen from the side where u goes right and v goes up, its triangles are
// counter-clockwise, and the UV (0, 0) is its upper left corner.
inline MeshData rectangle(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    MeshData mesh;
    for (const glm::vec3& vertex : {corner, corner + u, corner + u + v, corner + v})
        mesh.positions.insert(mesh.positions.end(), {vertex.x, vertex.y, vertex.z});
    for (int i = 0; i < 4; ++i) mesh.normals.insert(mesh.normals.end(), {normal.x, normal.y, normal.z});
    mesh.uvs = {0, 1, 1, 1, 1, 0, 0, 0};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

inline MeshData sphere(glm::vec3 centre, float radius, uint32_t rows) {
    MeshData mesh;
    const uint32_t columns = 2 * rows;
    for (uint32_t row = 0; row <= rows; ++row)
        for (uint32_t column = 0; column <= columns; ++column) {
            const double theta = std::numbers::pi * row / rows, phi = 2 * std::numbers::pi * column / columns;
            const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
            const glm::vec3 vertex = centre + radius * n;
            mesh.positions.insert(mesh.positions.end(), {vertex.x, vertex.y, vertex.z});
            mesh.normals.insert(mesh.normals.end(), {n.x, n.y, n.z});
            mesh.uvs.insert(mesh.uvs.end(), {static_cast<float>(column) / static_cast<float>(columns),
                                             static_cast<float>(row) / static_cast<float>(rows)});
        }
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t column = 0; column < columns; ++column) {
            const uint32_t a = row * (columns + 1) + column, b = a + columns + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, b + 1, a, b + 1, a + 1});
        }
    return mesh;
}

// Adds a mesh of one primitive with a new material and a new node; returns the node.
inline json& add_mesh(GlbBuilder& glb, const MeshData& mesh, const json& material = json::object(),
                      bool with_uvs = true) {
    json attributes = {{"POSITION", glb.vec3(mesh.positions)}, {"NORMAL", glb.vec3(mesh.normals)}};
    if (with_uvs) attributes["TEXCOORD_0"] = glb.floats(mesh.uvs, "VEC2", 2);
    glb.root["materials"].push_back(material);
    glb.root["meshes"].push_back({{"primitives",
                                   {{{"attributes", attributes},
                                     {"indices", glb.add(mesh.indices, kU32, "SCALAR", 1)},
                                     {"material", glb.root["materials"].size() - 1}}}}});
    glb.root["nodes"].push_back({{"mesh", glb.root["meshes"].size() - 1}});
    return glb.root["nodes"].back();
}

// Adds a texture; returns its index.
inline size_t add_texture(GlbBuilder& glb, const media::Image& image) {
    const std::vector<uint8_t> png = media::encode_png(image);
    glb.root["images"].push_back({{"bufferView", glb.add_view(png.data(), png.size())}, {"mimeType", "image/png"}});
    glb.root["textures"].push_back({{"source", glb.root["images"].size() - 1}});
    return glb.root["textures"].size() - 1;
}

inline media::Image one_colour(uint8_t r, uint8_t g, uint8_t b, uint8_t a = 255) {
    media::Image image(4, 4);
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        image.rgba[i] = r;
        image.rgba[i + 1] = g;
        image.rgba[i + 2] = b;
        image.rgba[i + 3] = a;
    }
    return image;
}

inline json pbr_material(glm::vec4 base, double metallic, double roughness) {
    return {{"pbrMetallicRoughness",
             {{"baseColorFactor", {base.r, base.g, base.b, base.a}},
              {"metallicFactor", metallic},
              {"roughnessFactor", roughness}}}};
}

// The images that the raster passes wrote, by texel of all views.
struct SetImages {
    std::vector<glm::dvec4> colour, front;
    std::vector<float> depth_m;
    // The device may move vertices to a grid of so many pixels before it draws triangles.
    double grid_px = 0;
};

// Vulkan allows any device such a grid; GPUs have one, lavapipe interpolates from the vertices as they are.
inline double raster_grid_px(const gpu::Device& device) {
    return device.summary().kind == "cpu" ? 0 : std::exp2(-static_cast<double>(device.limits().subPixelPrecisionBits));
}

inline std::vector<glm::dvec4> download_colours(const gpu::Device& device, const gpu::Buffer& from) {
    std::vector<uint16_t> halves(from.bytes / 2);
    gpu::download(device, from, halves.data(), from.bytes);
    std::vector<glm::dvec4> colours(halves.size() / 4);
    for (size_t i = 0; i < halves.size(); ++i)
        colours[i / 4][static_cast<int>(i % 4)] = voctree::float_from_half(halves[i]);
    return colours;
}

inline SetImages draw_set(const gpu::Device& device, render::SetRaster& set,
                          const std::vector<stage::Camera>& cameras) {
    gpu::run_once(device, "set", [&](gpu::Commands& commands) {
        set.lighting.record_lights(commands);
        set.record_shadows(commands);
        set.record_solid(commands, cameras);
        set.record_transparent(commands, cameras);
    });
    SetImages images{download_colours(device, set.targets().colour),
                     download_colours(device, set.targets().front),
                     {},
                     raster_grid_px(device)};
    images.depth_m.resize(set.targets().depth.bytes / 4);
    gpu::download(device, set.targets().depth, images.depth_m.data(), set.targets().depth.bytes);
    return images;
}

}  // namespace neuvv::test
