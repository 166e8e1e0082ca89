#include "interchange/mesh/mesh_gltf.h"

#include "interchange/mesh/gltf_frames.h"

namespace neuvv::interchange {

namespace {

constexpr uint32_t kVertices = 34962, kIndices = 34963, kLinear = 9729, kLinearMipmaps = 9987, kClamp = 33071;

}  // namespace

MeshGlb::MeshGlb() {
    glb_.json["extensionsUsed"] = {"KHR_materials_unlit"};
    glb_.json["samplers"] = {
        {{"magFilter", kLinear}, {"minFilter", kLinearMipmaps}, {"wrapS", kClamp}, {"wrapT", kClamp}}};
}

void MeshGlb::add(const ColouredMesh& frame) {
    if (frame.mesh.triangles.empty()) {
        meshes_.emplace_back();
        return;
    }
    const auto mark = [&](size_t accessor, uint32_t target) {
        glb_.json["bufferViews"].back()["target"] = target;
        return accessor;
    };
    std::vector<float> uvs;
    for (const glm::vec2& uv : frame.mesh.uvs) uvs.insert(uvs.end(), {uv.x, uv.y});
    std::vector<uint32_t> indices;
    for (const glm::uvec3& triangle : frame.mesh.triangles)
        indices.insert(indices.end(), {triangle.x, triangle.y, triangle.z});
    nlohmann::ordered_json attributes;
    attributes["POSITION"] = mark(glb_.add_positions(frame.mesh.positions), kVertices);
    attributes["NORMAL"] = mark(glb_.add_vectors(frame.mesh.normals), kVertices);
    attributes["TEXCOORD_0"] = mark(glb_.add(uvs, "VEC2", 2, stage::kGltfFloat), kVertices);
    const size_t of_triangles = mark(glb_.add(indices, "SCALAR", 1, stage::kGltfUnsignedInt), kIndices);
    const std::vector<uint8_t> png = media::encode_png(frame.texture);
    glb_.json["images"].push_back({{"mimeType", "image/png"}, {"bufferView", glb_.add_view(png.data(), png.size())}});
    glb_.json["textures"].push_back({{"sampler", 0}, {"source", glb_.json["images"].size() - 1}});
    const nlohmann::ordered_json texture = {{"index", glb_.json["textures"].size() - 1}};
    glb_.json["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", texture}, {"metallicFactor", 0}, {"roughnessFactor", 1}}},
         {"extensions", {{"KHR_materials_unlit", nlohmann::ordered_json::object()}}}});
    const nlohmann::ordered_json primitive = {
        {"attributes", attributes}, {"indices", of_triangles}, {"material", glb_.json["materials"].size() - 1}};
    meshes_.push_back({{"primitives", nlohmann::ordered_json::array({primitive})}});
}

void MeshGlb::write(const std::filesystem::path& file, double fps, const glm::dvec3& origin) {
    add_gltf_frames(glb_, meshes_, fps, origin);
    glb_.write(file, Remedy::kFewerFrames);
}

}  // namespace neuvv::interchange
