#include "stage/gltf/embedded.h"

#include <algorithm>
#include <array>

#include "stage/gltf/gltf_parse.h"

namespace neuvv::stage {

namespace {

using nlohmann::ordered_json;

void append_buffers(GlbWriter& glb, const tinygltf::Model& model) {
    std::vector<size_t> begins;
    for (const tinygltf::Buffer& buffer : model.buffers) {
        begins.push_back(glb.bytes.size());
        glb.bytes.insert(glb.bytes.end(), buffer.data.begin(), buffer.data.end());
        glb.bytes.resize((glb.bytes.size() + 3) / 4 * 4);
    }
    if (!glb.json.contains("bufferViews")) return;
    for (ordered_json& view : glb.json["bufferViews"]) {
        view["byteOffset"] = begins[view["buffer"].get<size_t>()] + view.value("byteOffset", size_t{0});
        view["buffer"] = 0;
        view.erase("extensions");  // EXT_meshopt_compression: the same again, elsewhere
    }
}

// glTF's name of what an image's file holds; null where it is none of its two kinds.
const char* mime_type_of(const std::vector<uint8_t>& file) {
    constexpr std::array<uint8_t, 4> kPng = {0x89, 'P', 'N', 'G'};
    constexpr std::array<uint8_t, 3> kJpeg = {0xff, 0xd8, 0xff};
    const auto begins_with = [&](const auto& magic) {
        return file.size() >= magic.size() && std::equal(magic.begin(), magic.end(), file.begin());
    };
    return begins_with(kPng) ? "image/png" : begins_with(kJpeg) ? "image/jpeg" : nullptr;
}

void append_images(GlbWriter& glb, const tinygltf::Model& model) {
    for (size_t i = 0; i < model.images.size(); ++i) {
        const std::vector<uint8_t>& file = model.images[i].image;  // empty where it lies in a buffer
        const char* const mime_type = mime_type_of(file);
        if (!mime_type) continue;
        const size_t view = glb.add_view(file.data(), file.size());
        ordered_json& image = glb.json["images"][i];
        image.erase("uri");
        image["mimeType"] = mime_type;
        image["bufferView"] = view;
    }
}

}  // namespace

GlbWriter embedded(StageFile file, const std::filesystem::path& output) {
    const tinygltf::Model model = parse_gltf(file.path, stage_bytes(file)).model;
    GlbWriter glb;
    glb.json = file.json.whole();
    append_buffers(glb, model);
    append_images(glb, model);
    glb.json.erase("buffers");
    file.json = StageJson(std::move(glb.json));
    glb.json = moved_to(std::move(file), output).json.whole();
    return glb;
}

}  // namespace neuvv::stage
