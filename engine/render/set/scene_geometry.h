// The triangles and textures of a glTF scene on the device, for both raster passes: captures (raster.h) and the set of
// a stage (set_raster.h). Vertices are posed on the CPU.
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
    int32_t material = -1;      // index into the scene's materials; −1: the default one
    bool mirrored = false;      // whether posed triangles are clockwise, seen from outside
    glm::vec3 low{0}, high{0};  // world, metres: the bounds of the posed vertices
};

enum class SceneDetail {
    kBase,     // streams 0 and 1, which the base colour needs
    kSurface,  // also streams 2 and 3: tangents, and the UVs of all maps
};

struct SceneGeometry {
    // Throws RuntimeFailure where the scene exceeds the device's memory or 2³¹ vertices. The scene must outlive it.
    SceneGeometry(const gpu::Device& device, const stage::GltfScene& scene, SceneDetail detail);

    const stage::GltfScene* scene;
    SceneDetail detail;
    std::vector<SceneDraw> draws;  // in the order of nodes and their primitives
    uint32_t vertex_count = 0, index_count = 0;
    gpu::Buffer moving, fixed;      // stream 0: position, normal; stream 1: UV of the base colour, colour
    gpu::Buffer tangents, map_uvs;  // streams 2 and 3
    gpu::Buffer indices;            // 32 bits, relative to the draw's first vertex
    glm::vec3 low{0}, high{0};      // world, metres: the bounds of all posed vertices
    stage::PosedScene pose;         // the pose of the vertices
    stage::PosedVertices scratch;
};

// Whether the vertices of all that `scene` draws are on the device, in the same order, so that nothing need be
// uploaded.
bool has_vertices_of(const SceneGeometry& geometry, const stage::GltfScene& scene);
// Replaces the scene by another one, for which has_vertices_of must be true. The pose is kept where all nodes are the
// same.
void repoint_geometry(SceneGeometry& geometry, const stage::GltfScene& scene);

// Whether no draw differs from `geometry.pose`.
bool has_pose(const SceneGeometry& geometry, const stage::PosedScene& pose);
// Poses the draws that differ from `geometry.pose`, and returns whether there were any. It writes memory that draws
// read, so no submitted work may draw the geometry meanwhile.
bool pose_geometry(SceneGeometry& geometry, const stage::PosedScene& pose);

// Sets the vertex streams and attributes of a pipeline (shared/raster.h has the locations).
void describe_streams(SceneDetail detail, gpu::GraphicsShape& shape);
void bind_streams(gpu::Commands& commands, const SceneGeometry& geometry);

// The material of this index; −1 is the default material of glTF.
const stage::GltfMaterial& material_at(const stage::GltfScene& scene, int32_t index);

// Textures with their samplers. A texture has an entry for sRGB, for numbers, or for both. The first entry is white.
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
// Whether two scenes have equal textures at each index.
bool same_textures(const stage::GltfScene& a, const stage::GltfScene& b);
// Returns the index of the texture's entry, after uploading it if it is new. `texture` −1 is white. It waits for the
// device, so it is for set-up.
size_t add_texture(const gpu::Device& device, const stage::GltfScene& scene, SceneTextures& textures, int32_t texture,
                   bool srgb);

}  // namespace neuvv::render
