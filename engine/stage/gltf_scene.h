// A glTF 2.0 model as plain, validated data: what a reader may index without checking again.
//
// Units and spaces are glTF's: metres, +Y up, right-handed, colours of factors and vertices linear, UV from the top
// left. pose.h evaluates it at a time.
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

// The textures of a material beside its base colour.
enum class GltfMap { kMetallicRoughness, kNormal, kOcclusion, kEmissive };
constexpr size_t kGltfMaps = 4;

struct GltfMaterial {
    std::string name;
    glm::vec4 base_color{1};  // linear, straight alpha
    int32_t texture = -1;     // base colour, sRGB; index into GltfScene::textures, −1 without
    GltfAlpha alpha = GltfAlpha::kOpaque;
    float alpha_cutoff = 0.5f;
    bool double_sided = false;
    bool unlit = false;  // KHR_materials_unlit
    float metallic = 1;
    float roughness = 1;
    // By GltfMap, −1 without: roughness in green and metallic in blue; tangent-space normals; occlusion in red; these
    // three are numbers, emission is sRGB.
    std::array<int32_t, kGltfMaps> maps{-1, -1, -1, -1};
    float normal_scale = 1;
    float occlusion_strength = 1;
    glm::vec3 emissive{0};  // linear; KHR_materials_emissive_strength multiplied in

    int32_t map(GltfMap which) const { return maps[static_cast<size_t>(which)]; }
};

// Displacements to add, weighted, to a primitive's vertices; normals may be empty.
struct GltfMorphTarget {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
};

// A triangle list. Every vertex array is empty or as long as positions; every index is < positions.size().
struct GltfPrimitive {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // unit; never empty: flat normals where the file has none
    std::vector<glm::vec2> uvs;      // the set its material asks for, KHR_texture_transform applied; may be empty
    // By GltfMap: as uvs; empty where the material has no such map or the file no such set.
    std::array<std::vector<glm::vec2>, kGltfMaps> map_uvs;
    // Unit, along the normal map's U; w ±1: bitangent = cross(normal, tangent) · w. Empty without a normal map.
    std::vector<glm::vec4> tangents;
    std::vector<glm::vec4> colors;     // COLOR_0, linear; may be empty
    std::vector<glm::u16vec4> joints;  // indices into GltfSkin::joints; empty where not skinned
    std::vector<glm::vec4> weights;    // sum 1; as long as joints
    std::vector<uint32_t> indices;     // three a triangle, counter-clockwise from outside
    std::vector<GltfMorphTarget> targets;
    uint32_t joint_count = 0;  // one past the largest of `joints`
    int32_t material = -1;     // index into GltfScene::materials, −1: glTF's default material
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;  // all with the same number of morph targets
    std::vector<float> weights;             // default weight of each morph target
};

// Looks along its node's −Z. A node's scale does not count.
struct GltfCamera {
    std::string name;
    bool orthographic = false;      // no image of ours: kept so that it can be named
    double vertical_angle_rad = 0;  // of view, 0 where orthographic
};

enum class GltfLightKind { kDirectional, kPoint, kSpot };

// KHR_lights_punctual: shines along its node's −Z, from its origin. A node's scale does not count.
struct GltfLight {
    std::string name;
    GltfLightKind kind = GltfLightKind::kPoint;
    glm::dvec3 color{1};                            // linear RGB
    double intensity = 1;                           // candela; lux where directional
    double range_m = 0;                             // where the light ends; 0: nowhere
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
    std::vector<float> weights;  // one a morph target of the mesh
    int32_t camera = -1;         // index into GltfScene::cameras
    int32_t light = -1;          // index into GltfScene::lights
    bool in_scene = false;       // reached from the default scene: only these are drawn
    bool visible = true;         // KHR_node_visibility, of the node and all above it

    bool draws_mesh() const { return in_scene && visible && mesh >= 0; }
};

struct GltfSkin {
    std::string name;
    std::vector<uint32_t> joints;           // node indices
    std::vector<glm::dmat4> inverse_binds;  // one a joint
};

enum class GltfPath { kTranslation, kRotation, kScale, kWeights };
enum class GltfInterpolation { kLinear, kStep, kCubicSpline };

struct GltfChannel {
    uint32_t node = 0;
    GltfPath path = GltfPath::kTranslation;
    GltfInterpolation interpolation = GltfInterpolation::kLinear;
    uint32_t components = 3;    // of one value: 3, 4 (rotation x y z w) or the number of morph targets
    std::vector<float> times;   // seconds, strictly ascending, not empty
    std::vector<float> values;  // times × components; kCubicSpline: × 3, [in-tangents | value | out-tangents] a key
};

struct GltfAnimation {
    std::string name;
    double duration_s = 0;  // the last key of any channel
    std::vector<GltfChannel> channels;
};

// An image as its file has it, and its pixels.
struct GltfImage {
    std::vector<uint8_t> encoded;
    media::Image pixels;
};

// A list that copies share; it does not change.
template <typename Element>
class SharedList {
  public:
    SharedList() : SharedList(std::vector<Element>{}) {}
    SharedList(std::vector<Element> elements)  // NOLINT: a list is what it holds
        : elements_(std::make_shared<const std::vector<Element>>(std::move(elements))) {}
    size_t size() const { return elements_->size(); }
    bool empty() const { return elements_->empty(); }
    const Element& operator[](size_t index) const { return (*elements_)[index]; }
    const Element& at(size_t index) const { return elements_->at(index); }
    auto begin() const { return elements_->begin(); }
    auto end() const { return elements_->end(); }
    // Whether both are the very same list.
    bool shares(const SharedList& other) const { return elements_ == other.elements_; }

  private:
    std::shared_ptr<const std::vector<Element>> elements_;
};

struct GltfScene {
    std::string file;  // for error messages
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

// Reads .gltf (JSON, with buffers and images beside it or in data URIs) or .glb; told apart by content. Throws
// InputError with file, JSON place, problem and fix for whatever breaks the promises above, for a required extension
// it does not know, and for URIs that leave the file's folder.
GltfScene load_gltf(const std::filesystem::path& path);
// The same for a file's bytes that are not on the disk; what they name is read from beside `path`. Images that `before`
// has, too, are shared with it: to decode them is the costly part.
GltfScene load_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes, const GltfScene* before = nullptr);
// The same of a document without the members that name bytes: buffers, images, and what is made of them, which is
// shared with `before`, the scene of that document with other nodes. Nothing where its skins or animations do not fit
// these nodes: load_gltf says why.
std::optional<GltfScene> load_gltf_nodes(const std::filesystem::path& path, std::vector<uint8_t> bytes,
                                         const GltfScene& before);

// The animation of this name, or of this index in decimal. Throws InputError listing what there is.
uint32_t find_animation(const GltfScene& scene, const std::string& name_or_index);

}  // namespace neuvv::stage
