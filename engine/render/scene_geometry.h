// A glTF scene's triangles and textures on the device, as both raster passes draw them: captures (raster.h) and the set
// of a stage (set_raster.h). Vertices are posed on the CPU.
#pragma once

#include <vector>

#include "gpu/graphics_pass.h"
#include "stage/pose.h"

namespace neuvv::render {

// One primitive of one node.
struct SceneDraw {
    uint32_t node = 0;
    const stage::GltfPrimitive* primitive = nullptr;
    uint32_t first_vertex = 0, first_index = 0;
    int32_t material = -1;      // glTF's, −1: the default one
    bool mirrored = false;      // clockwise from outside, as posed
    glm::vec3 low{0}, high{0};  // world, metres: the box of its vertices, as posed
};

enum class SceneDetail {
    kBase,     // streams 0 and 1: what the base colour needs
    kSurface,  // and 2 and 3: tangents, and the UVs of all maps
};

struct SceneGeometry {
    // Throws RuntimeFailure where the scene exceeds the device. The scene must outlive this.
    SceneGeometry(const gpu::Device& device, const stage::GltfScene& scene, SceneDetail detail);

    const stage::GltfScene* scene;
    SceneDetail detail;
    std::vector<SceneDraw> draws;  // in the order of nodes and primitives
    uint32_t vertex_count = 0, index_count = 0;
    gpu::Buffer moving, fixed;      // streams 0: position, normal; 1: UV of the base colour, colour
    gpu::Buffer tangents, map_uvs;  // streams 2 and 3
    gpu::Buffer indices;            // 32 bits, of the draw's own vertices
    glm::vec3 low{0}, high{0};      // world, metres: the box of all that is posed
    stage::PosedScene pose;         // what the vertices show
    stage::PosedVertices scratch;
};

// Whether the device has all vertices of what `scene` draws, in its order: then nothing need be uploaded to draw it.
bool has_vertices_of(const SceneGeometry& geometry, const stage::GltfScene& scene);
// From now on it draws that scene, whose vertices it must have; what stands on the same node stays posed.
void repoint_geometry(SceneGeometry& geometry, const stage::GltfScene& scene);

// Poses what differs from `geometry.pose`, and says whether anything did. Host memory that draws read: nothing that is
// under way may draw it.
bool pose_geometry(SceneGeometry& geometry, const stage::PosedScene& pose);

// Streams and attributes of the vertex shader (shared/raster.h has their locations).
void describe_streams(SceneDetail detail, gpu::GraphicsShape& shape);
void bind_streams(gpu::Commands& commands, const SceneGeometry& geometry);

// What glTF says of a primitive without material.
const stage::GltfMaterial& material_at(const stage::GltfScene& scene, int32_t index);

// Textures with their samplers, each once for every way it is read; the first is white.
struct SceneTextures {
    struct Entry {
        int32_t texture = -1;
        bool srgb = true;
        gpu::DeviceImage image;
        gpu::Sampler sampler;
    };
    std::vector<Entry> entries;
};
SceneTextures make_textures(const gpu::Device& device);
// Whether textures of one scene are those of the other, by index.
bool same_textures(const stage::GltfScene& a, const stage::GltfScene& b);
// Index of the entry, uploaded if it is new. `texture` −1 is white. Set-up only.
size_t add_texture(const gpu::Device& device, const stage::GltfScene& scene, SceneTextures& textures, int32_t texture,
                   bool srgb);

}  // namespace neuvv::render
