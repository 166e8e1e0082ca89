// A glTF 2.0 model as plain, validated data: code that reads it may use its indices without checking them again.
//
// Units and spaces are glTF's: metres, +Y up, right-handed, colours of factors and vertices linear, UV from the top
// left. pose.h evaluates a scene at a time.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "media/image.h"

namespace neuvv::stage {

constexpr const char* kVisibilityExtension = "KHR_node_visibility";

enum class GltfWrap { kRepeat, kMirroredRepeat, kClampToEdge };

struct GltfTexture {
    uint32_t image = 0;  // index into GltfScene::images
    GltfWrap wrap_u = GltfWrap::kRepeat;
    GltfWrap wrap_v = GltfWrap::kRepeat;
    bool nearest_magnification = false;
    bool nearest_minification = false;
    bool mipmaps = true;
};

enum class GltfAlpha { kOpaque, kMask, kBlend };

// The textures of a material besides its base colour.
enum class GltfMap { kMetallicRoughness, kNormal, kOcclusion, kEmissive };
constexpr size_t kGltfMaps = 4;

struct GltfMaterial {
    std::string name;
    glm::vec4 base_color{1};  // linear, straight alpha
    int32_t texture = -1;     // of the base colour, sRGB; index into GltfScene::textures, −1: none
    GltfAlpha alpha = GltfAlpha::kOpaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;  // KHR_materials_unlit
    float metallic = 1;
    float roughness = 1;
    // Indices into GltfScene::textures by GltfMap, −1: none. The first has roughness in green and metallic in blue, the
    // second tangent-space normals, the third occlusion in red; these three hold linear numbers. The fourth, emission,
    // is sRGB.
    std::array<int32_t, kGltfMaps> maps{-1, -1, -1, -1};
    float normal_scale = 1;
    float occlusion_strength = 1;
    glm::vec3 emissive{0};  // linear; KHR_materials_emissive_strength multiplied in

    int32_t map(GltfMap which) const { return maps[static_cast<size_t>(which)]; }
};

// Displacements of a primitive's vertices, which are added times the target's weight; `normals` may be empty.
struct GltfMorphTarget {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
};

// A triangle list. Every vertex array but joints and weights is empty or as long as positions; every index is <
// positions.size().
struct GltfPrimitive {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit; never empty: flat normals where the file has none
    std::vector<glm::vec2> uvs;      // the base colour's UV set with KHR_texture_transform applied; may be empty
    // The same for the other textures, by GltfMap; empty where the material has no such map or the file no such UV set.
    std::array<std::vector<glm::vec2>, kGltfMaps> map_uvs;
    // Unit tangents along the normal map's U; w = ±1: bitangent = cross(normal, tangent) · w. Empty without a normal
    // map.
    std::vector<glm::vec4> tangents;
    std::vector<glm::vec4> colors;  // COLOR_0, linear; may be empty
    // Indices into GltfSkin::joints, `joint_sets` of four for each vertex, one vertex after the other; empty where not
    // skinned.
    std::vector<glm::u16vec4> joints;
    std::vector<glm::vec4> weights;  // the sum of a vertex is 1; as long as joints
    std::vector<uint32_t> indices;   // three a triangle, counter-clockwise from outside
    std::vector<GltfMorphTarget> targets;
    uint32_t joint_sets = 1;   // JOINTS_0, JOINTS_1 and so on
    uint32_t joint_count = 0;  // one past the largest of `joints`
    int32_t material = -1;     // index into GltfScene::materials, −1: glTF's default material
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;  // all with the same number of morph targets
    std::vector<float> weights;             // the default weight of each morph target
};

// The camera looks along its node's −Z; the node's scale is ignored.
struct GltfCamera {
    std::string name;
    bool orthographic = false;      // orthographic cameras are not drawn; they are kept for messages about them
    double vertical_angle_rad = 0;  // the whole vertical angle of view; 0 where orthographic
};

enum class GltfLightKind { kDirectional, kPoint, kSpot };

// A light of KHR_lights_punctual. It shines from its node's origin along the node's −Z; the node's scale is ignored.
struct GltfLight {
    std::string name;
    GltfLightKind kind = GltfLightKind::kPoint;
    glm::dvec3 color{1};                            // linear RGB
    double intensity = 1;                           // candela; lux where directional
    double range_m = 0;                             // the distance at which the light ends; 0: unlimited
    double inner_cone_rad = 0, outer_cone_rad = 0;  // half angles of a spot, inner < outer <= π/2
};

struct GltfNode {
    std::string name;
    int32_t parent = -1;
    std::vector<uint32_t> children;
    bool has_matrix = false;  // `matrix` is the local transform; else translation, rotation, scale are
    glm::dmat4 matrix{1};
    glm::dvec3 translation{0};
    glm::dquat rotation{1, 0, 0, 0};
    glm::dvec3 scale{1};
    int32_t mesh = -1;
    int32_t skin = -1;           // only with a mesh whose primitives all have joints
    std::vector<float> weights;  // one for each morph target of the mesh
    int32_t camera = -1;         // index into GltfScene::cameras
    int32_t light = -1;          // index into GltfScene::lights
    bool in_scene = false;       // belongs to the default scene; other nodes are not drawn
    bool visible = true;         // KHR_node_visibility: neither the node nor one of its ancestors is hidden

    bool draws_mesh() const { return in_scene && visible && mesh >= 0; }
};

struct GltfSkin {
    std::string name;
    std::vector<uint32_t> joints;           // node indices
    std::vector<glm::dmat4> inverse_binds;  // one for each joint
};

enum class GltfPath { kTranslation, kRotation, kScale, kWeights };
enum class GltfInterpolation { kLinear, kStep, kCubicSpline };

struct GltfChannel {
    uint32_t node = 0;
    GltfPath path = GltfPath::kTranslation;
    GltfInterpolation interpolation = GltfInterpolation::kLinear;
    uint32_t components = 3;    // of one value: 3, 4 (rotation x y z w) or the number of morph targets
    std::vector<float> times;   // seconds, strictly ascending, not empty
    std::vector<float> values;  // times × components; kCubicSpline: × 3, [in-tangents | value | out-tangents] per key
};

struct GltfAnimation {
    std::string name;
    double duration_s = 0;  // time of the last key of all channels
    std::vector<GltfChannel> channels;
};

struct GltfImage {
    std::vector<uint8_t> encoded;  // the image's file
    media::Image pixels;
};

// An immutable list whose elements are shared by its copies.
template <typename Element>
class SharedList {
  public:
    SharedList() : SharedList(std::vector<Element>{}) {}
    SharedList(std::vector<Element> elements)  // NOLINT: implicit, because it is the same list
        : elements_(std::make_shared<const std::vector<Element>>(std::move(elements))) {}
    size_t size() const { return elements_->size(); }
    bool empty() const { return elements_->empty(); }
    const Element& operator[](size_t index) const { return (*elements_)[index]; }
    const Element& at(size_t index) const { return elements_->at(index); }
    auto begin() const { return elements_->begin(); }
    auto end() const { return elements_->end(); }
    // Whether both are copies of the same list, so that no comparison of elements is needed.
    bool shares(const SharedList& other) const { return elements_ == other.elements_; }

  private:
    std::shared_ptr<const std::vector<Element>> elements_;
};

struct GltfScene {
    std::string file;  // for error messages
    // What of the file is not shown, one line each: "does not read KHR_materials_clearcoat".
    std::vector<std::string> notes;
    std::vector<GltfNode> nodes;
    std::vector<uint32_t> order;  // every node index once, parents before children
    SharedList<GltfMesh> meshes;
    std::vector<GltfMaterial> materials;
    std::vector<GltfTexture> textures;
    std::vector<std::shared_ptr<const GltfImage>> images;  // null where no material uses the image
    SharedList<GltfSkin> skins;
    SharedList<GltfAnimation> animations;
    std::vector<GltfCamera> cameras;
    std::vector<GltfLight> lights;
    int32_t root = -1;  // the default scene's index, −1 where the file has none
};

// Reads a .gltf (JSON, with buffers and images beside it or in data URIs) or a .glb; the content decides which. Throws
// InputError with file, JSON location, problem and fix where the guarantees above would be broken, for an unknown
// required extension, and for URIs that leave the file's folder.
GltfScene load_gltf(const std::filesystem::path& path);
// The same for bytes in memory; the files that they name are read relative to the folder of `path`. Images that are
// also in `before` are shared with it, because decoding images is the expensive part.
GltfScene load_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes, const GltfScene* before = nullptr);
// The same for a document from which buffers, images, and all members that refer to their bytes were removed. What
// those members hold (meshes, materials, textures, images, skins, animations) is shared with `before`, the scene of the
// same document with other nodes. Returns nothing where the skins or animations do not fit the new nodes; load_gltf of
// the whole document then throws the error.
std::optional<GltfScene> load_gltf_nodes(const std::filesystem::path& path, std::vector<uint8_t> bytes,
                                         const GltfScene& before);

// The index of the animation of this name, or of this index in decimal. Throws InputError that lists the animations
// where there is no such one.
uint32_t find_animation(const GltfScene& scene, const std::string& name_or_index);

}  // namespace neuvv::stage
