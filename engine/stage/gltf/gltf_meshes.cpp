#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "stage/gltf/gltf_mend.h"
#include "stage/gltf/gltf_parse.h"
#include "stage/gltf/gltf_scene.h"
#include "stage/gltf/gltf_tangents.h"

namespace neuvv::stage {

namespace {

constexpr size_t kMaxMorphTargets = 256;

template <typename Vector>
std::vector<Vector> packed(const std::vector<float>& values) {
    constexpr auto kWidth = static_cast<size_t>(Vector::length());
    std::vector<Vector> out(values.size() / kWidth);
    for (size_t i = 0; i < values.size(); ++i) out[i / kWidth][static_cast<int>(i % kWidth)] = values[i];
    return out;
}

struct PrimitiveLoader {
    const GltfScene& scene;
    AccessorReader& reader;
    const tinygltf::Primitive& source;
    std::string place;
    GltfPrimitive out;

    [[noreturn]] void fail(const std::string& where, const std::string& problem, const std::string& fix = "") const {
        throw InputError(scene.file, place + where, problem, fix);
    }
    int attribute(const std::string& name) const {
        const auto found = source.attributes.find(name);
        return found == source.attributes.end() ? -1 : found->second;
    }
    void check_count(size_t count, const std::string& name) const {
        if (count != out.positions.size())
            fail(name, fmt::format("has {} elements for {} vertices", count, out.positions.size()));
    }
    template <typename Vector>
    std::vector<Vector> vectors(int accessor, const std::string& name) {
        auto values = packed<Vector>(read_floats(reader, accessor, Vector::length(), place + name));
        if (!out.positions.empty()) check_count(values.size(), name);
        return values;
    }
    // Counts memory that is allocated for the file without being read from it against the reader's budget.
    void spend(uint64_t components) {
        if (components > reader.budget) fail("", "has more vertices than this program takes", "simplify the model");
        reader.budget -= components;
    }
    std::vector<glm::vec2> uvs_of(const TextureTransform& transform);
    void read_uvs(const MaterialTransforms& transforms);
    void read_tangents();
    void read_colors();
    void read_skin_set(uint32_t set);
    void read_skin();
    void read_indices();
    void read_targets();
    void read_vertices();
};

std::vector<glm::vec2> PrimitiveLoader::uvs_of(const TextureTransform& transform) {
    const std::string name = fmt::format("TEXCOORD_{}", transform.uv_set);
    const int accessor = attribute(name);
    if (accessor < 0) return {};
    // KHR_mesh_quantization has integers that are not normalised: the texture transform scales them.
    std::vector<glm::vec2> uvs = vectors<glm::vec2>(accessor, "/attributes/" + name);
    // KHR_texture_transform: scale, then rotation, then offset.
    const float c = std::cos(transform.rotation), s = std::sin(transform.rotation);
    for (glm::vec2& uv : uvs) {
        uv *= transform.scale;
        uv = glm::vec2(c * uv.x + s * uv.y, -s * uv.x + c * uv.y) + transform.offset;
    }
    return uvs;
}

void PrimitiveLoader::read_uvs(const MaterialTransforms& transforms) {
    out.uvs = uvs_of(transforms.base);
    if (out.material < 0) return;
    for (size_t map = 0; map < kGltfMaps; ++map)
        if (scene.materials[static_cast<size_t>(out.material)].maps[map] >= 0)
            out.map_uvs[map] = uvs_of(transforms.maps[map]);
}

bool has_normal_map(const GltfScene& scene, const GltfPrimitive& primitive) {
    return primitive.material >= 0 &&
           scene.materials[static_cast<size_t>(primitive.material)].map(GltfMap::kNormal) >= 0;
}

// As glTF demands, the file's tangents are ignored where it has no normals.
void PrimitiveLoader::read_tangents() {
    if (attribute("TANGENT") < 0 || attribute("NORMAL") < 0 || !has_normal_map(scene, out)) return;
    out.tangents = vectors<glm::vec4>(attribute("TANGENT"), "/attributes/TANGENT");
    for (size_t v = 0; v < out.tangents.size(); ++v)
        out.tangents[v] = tangent_across(out.normals[v], glm::vec3(out.tangents[v]), out.tangents[v].w < 0);
}

void PrimitiveLoader::read_colors() {
    const int accessor = attribute("COLOR_0");
    if (accessor < 0) return;
    const std::string name = "/attributes/COLOR_0";
    if (accessor_components(reader, accessor, place + name) == 3) {
        for (const glm::vec3& rgb : vectors<glm::vec3>(accessor, name)) out.colors.emplace_back(rgb, 1.0f);
    } else {
        out.colors = vectors<glm::vec4>(accessor, name);
    }
    if (is_raw_integer(reader, accessor)) fail(name, "is neither float nor normalised");
}

// One of JOINTS_n and WEIGHTS_n, as many as there are without a gap.
void PrimitiveLoader::read_skin_set(uint32_t set) {
    const std::string joints_name = fmt::format("JOINTS_{}", set), weights_name = fmt::format("WEIGHTS_{}", set);
    const int joints = attribute(joints_name), weights = attribute(weights_name);
    if (joints < 0 || weights < 0)
        fail("/attributes", fmt::format("has only one of {} and {}", joints_name, weights_name));
    const std::string weights_place = "/attributes/" + weights_name, joints_place = "/attributes/" + joints_name;
    const std::vector<uint32_t> indices = read_integers(reader, joints, 4, place + joints_place);
    check_count(indices.size() / 4, joints_place);
    const std::vector<glm::vec4> read = vectors<glm::vec4>(weights, weights_place);
    if (is_raw_integer(reader, weights)) fail(weights_place, "is neither float nor normalised");
    for (size_t v = 0; v < out.positions.size(); ++v)
        for (int k = 0; k < 4; ++k) {
            const float weight = read[v][k];
            const uint32_t joint = indices[v * 4 + static_cast<size_t>(k)];
            if (weight < 0 || weight > 1e6f) fail(weights_place, fmt::format("vertex {} has weight {}", v, weight));
            if (weight == 0) continue;  // exporters leave arbitrary joint numbers where the weight is 0
            if (joint > UINT16_MAX) fail(joints_place, fmt::format("vertex {} has joint {}", v, joint));
            out.joints[v * out.joint_sets + set][k] = static_cast<uint16_t>(joint);
            out.weights[v * out.joint_sets + set][k] = weight;
            out.joint_count = std::max(out.joint_count, joint + 1);
        }
}

void PrimitiveLoader::read_skin() {
    uint32_t sets = 0;
    while (attribute(fmt::format("JOINTS_{}", sets)) >= 0 || attribute(fmt::format("WEIGHTS_{}", sets)) >= 0) ++sets;
    if (sets == 0) return;
    spend(uint64_t{8} * sets * out.positions.size());
    out.joint_sets = sets;
    out.joint_count = 1;
    out.joints.assign(sets * out.positions.size(), glm::u16vec4(0));
    out.weights.assign(sets * out.positions.size(), glm::vec4(0));
    for (uint32_t set = 0; set < sets; ++set) read_skin_set(set);
    for (size_t v = 0; v < out.positions.size(); ++v) {
        glm::vec4* weights = &out.weights[v * sets];
        float sum = 0;
        for (uint32_t set = 0; set < sets; ++set)
            for (int k = 0; k < 4; ++k) sum += weights[set][k];
        if (sum == 0) weights[0].x = sum = 1;
        for (uint32_t set = 0; set < sets; ++set) weights[set] /= sum;
    }
}

// Turns strips and fans into lists. Two corners of every second triangle of a strip are swapped to keep the winding.
std::vector<uint32_t> triangle_list(const std::vector<uint32_t>& indices, int mode) {
    if (mode == TINYGLTF_MODE_TRIANGLES) return indices;
    std::vector<uint32_t> list;
    for (size_t i = 0; i + 2 < indices.size(); ++i) {
        const bool fan = mode == TINYGLTF_MODE_TRIANGLE_FAN, odd = i % 2 == 1;
        const uint32_t a = fan ? indices[0] : indices[i];
        const uint32_t b = fan ? indices[i + 1] : indices[odd ? i + 2 : i + 1];
        const uint32_t c = fan ? indices[i + 2] : indices[odd ? i + 1 : i + 2];
        // Strips are joined by triangles without area, which are left out.
        if (a != b && b != c && c != a) list.insert(list.end(), {a, b, c});
    }
    return list;
}

void PrimitiveLoader::read_indices() {
    const int mode = source.mode;
    if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP && mode != TINYGLTF_MODE_TRIANGLE_FAN)
        fail("/mode", fmt::format("{} is not triangles, a strip or a fan", mode), "export triangles only");
    std::vector<uint32_t> indices;
    const int accessor = source.indices >= 0 ? source.indices : attribute(kSparseIndices);
    if (accessor >= 0) {
        indices = stage::read_integers(reader, accessor, 1, place + "/indices");
        for (size_t i = 0; i < indices.size(); ++i)
            if (indices[i] >= out.positions.size())
                fail("/indices",
                     fmt::format("element {} is {}, past the {} vertices", i, indices[i], out.positions.size()));
    } else {
        indices.resize(out.positions.size());
        for (size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<uint32_t>(i);
    }
    if (mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0)
        fail("/indices", fmt::format("{} corners are not whole triangles", indices.size()));
    out.indices = triangle_list(indices, mode);
}

void PrimitiveLoader::read_targets() {
    if (source.targets.size() > kMaxMorphTargets)
        fail("/targets",
             fmt::format("has {} morph targets, this program takes {}", source.targets.size(), kMaxMorphTargets));
    for (size_t t = 0; t < source.targets.size(); ++t) {
        GltfMorphTarget target;
        for (const auto& [name, accessor] : source.targets[t]) {
            const std::string at = fmt::format("/targets/{}/{}", t, name);
            if (name == "POSITION") target.positions = vectors<glm::vec3>(accessor, at);
            if (name == "NORMAL") target.normals = vectors<glm::vec3>(accessor, at);
        }
        if (target.positions.empty()) {
            spend(out.positions.size() * 3);
            target.positions.assign(out.positions.size(), glm::vec3(0));
        }
        out.targets.push_back(std::move(target));
    }
}

void PrimitiveLoader::read_vertices() {
    out.positions = vectors<glm::vec3>(attribute("POSITION"), "/attributes/POSITION");
    if (attribute("NORMAL") < 0) return;
    out.normals = vectors<glm::vec3>(attribute("NORMAL"), "/attributes/NORMAL");
    for (glm::vec3& normal : out.normals) {
        const float length = glm::length(normal);
        normal = std::isfinite(length) && length > 1e-12f ? normal / length : glm::vec3(0, 1, 0);
    }
}

// `width`: values of a vertex.
template <typename Vector>
void unshare(std::vector<Vector>& values, const std::vector<uint32_t>& indices, size_t width = 1) {
    if (values.empty()) return;
    std::vector<Vector> out;
    out.reserve(indices.size() * width);
    for (const uint32_t index : indices)
        for (size_t i = 0; i < width; ++i) out.push_back(values[index * width + i]);
    values = std::move(out);
}

// As glTF demands, faces are flat where the file has no normals. Each corner of a triangle then needs its own vertex.
void add_flat_normals(GltfPrimitive& primitive) {
    const std::vector<uint32_t>& indices = primitive.indices;
    unshare(primitive.positions, indices);
    unshare(primitive.uvs, indices);
    for (std::vector<glm::vec2>& uvs : primitive.map_uvs) unshare(uvs, indices);
    unshare(primitive.colors, indices);
    unshare(primitive.joints, indices, primitive.joint_sets);
    unshare(primitive.weights, indices, primitive.joint_sets);
    for (GltfMorphTarget& target : primitive.targets) {
        unshare(target.positions, indices);
        target.normals.clear();
    }
    primitive.normals.resize(primitive.positions.size());
    for (size_t i = 0; i + 2 < primitive.positions.size(); i += 3) {
        const glm::dvec3 a = primitive.positions[i], b = primitive.positions[i + 1], c = primitive.positions[i + 2];
        const glm::dvec3 cross = glm::cross(b - a, c - a);
        const double length = glm::length(cross);
        const glm::vec3 normal = length > 0 && std::isfinite(length) ? glm::vec3(cross / length) : glm::vec3(0, 1, 0);
        for (size_t k = 0; k < 3; ++k) primitive.normals[i + k] = normal;
    }
    for (size_t i = 0; i < primitive.indices.size(); ++i) primitive.indices[i] = static_cast<uint32_t>(i);
}

GltfPrimitive load_primitive(const GltfScene& scene, AccessorReader& reader, const tinygltf::Primitive& source,
                             const std::string& place, const std::vector<MaterialTransforms>& transforms) {
    PrimitiveLoader loader{scene, reader, source, place, {}};
    if (source.material >= static_cast<int>(scene.materials.size()))
        loader.fail("/material", fmt::format("{} does not exist", source.material));
    loader.out.material = source.material < 0 ? -1 : source.material;
    loader.read_vertices();
    loader.read_uvs(source.material < 0 ? MaterialTransforms{} : transforms[static_cast<size_t>(source.material)]);
    loader.read_tangents();
    loader.read_colors();
    loader.read_skin();
    loader.read_targets();
    loader.read_indices();
    if (loader.out.normals.empty()) {
        // There may be many more corners than vertices, so they count against the budget, too.
        const uint64_t widths = 8 + 8 * loader.out.joint_sets + 2 * kGltfMaps + 3 * loader.out.targets.size();
        loader.spend(widths * loader.out.indices.size());
        add_flat_normals(loader.out);
    }
    if (has_normal_map(scene, loader.out) && loader.out.tangents.empty()) {
        loader.spend(4 * loader.out.positions.size());
        add_tangents(loader.out);
    }
    return std::move(loader.out);
}

// Of morph targets, positions and normals are read; tangents follow from those.
bool has_other_targets(const tinygltf::Primitive& primitive) {
    for (const std::map<std::string, int>& target : primitive.targets)
        for (const auto& [name, accessor] : target)
            if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") return true;
    return false;
}

// Points and lines are left out. Splats of KHR_gaussian_splatting are points, too.
bool is_of_points_or_lines(const tinygltf::Primitive& primitive) {
    return primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode <= TINYGLTF_MODE_LINE_STRIP;
}

}  // namespace

void load_meshes(GltfScene& scene, AccessorReader& reader, const std::vector<MaterialTransforms>& transforms) {
    std::vector<GltfMesh> meshes;
    std::string without_surface;                      // meshes that have points and lines
    size_t other_targets = 0, without_positions = 0;  // primitives
    for (size_t m = 0; m < reader.model.meshes.size(); ++m) {
        const tinygltf::Mesh& source = reader.model.meshes[m];
        const std::string place = fmt::format("/meshes/{}", m);
        GltfMesh mesh;
        mesh.name = source.name;
        bool has_points_or_lines = false;
        if (source.primitives.empty()) throw InputError(scene.file, place, "has no primitives");
        for (size_t p = 0; p < source.primitives.size(); ++p) {
            const std::string at = fmt::format("{}/primitives/{}", place, p);
            if (is_of_points_or_lines(source.primitives[p])) {
                has_points_or_lines = true;
                continue;
            }
            if (!source.primitives[p].attributes.contains("POSITION")) {
                ++without_positions;
                continue;
            }
            other_targets += has_other_targets(source.primitives[p]) ? 1 : 0;
            mesh.primitives.push_back(load_primitive(scene, reader, source.primitives[p], at, transforms));
            if (mesh.primitives.back().targets.size() != mesh.primitives[0].targets.size())
                throw InputError(scene.file, at, "has another number of morph targets than the mesh's first primitive");
        }
        if (has_points_or_lines)
            without_surface += fmt::format("{}{}", without_surface.empty() ? "" : ", ",
                                           mesh.name.empty() ? fmt::format("mesh {}", m) : mesh.name);
        const size_t targets =
            mesh.primitives.empty() ? source.primitives[0].targets.size() : mesh.primitives[0].targets.size();
        if (!source.weights.empty() && source.weights.size() != targets)
            throw InputError(scene.file, place + "/weights",
                             fmt::format("has {} weights for {} morph targets", source.weights.size(), targets));
        mesh.weights.assign(targets, 0.0f);
        for (size_t i = 0; i < source.weights.size(); ++i) mesh.weights[i] = static_cast<float>(source.weights[i]);
        meshes.push_back(std::move(mesh));
    }
    scene.meshes = std::move(meshes);
    if (!without_surface.empty()) scene.notes.push_back("draws no points, lines or splats: " + without_surface);
    if (without_positions > 0)
        scene.notes.push_back(fmt::format("leaves out {} primitives without positions", without_positions));
    if (other_targets > 0)
        scene.notes.push_back(
            fmt::format("morphs positions and normals; {} primitives have targets of colours or texture coordinates",
                        other_targets));
}

}  // namespace neuvv::stage
