#include <nlohmann/json.hpp>

#include "stage/gltf_parse.h"

#include <fmt/format.h>

#include <cstring>

#include "base/error.h"
#include "base/platform.h"
#include "stage/gltf_container.h"
#include "stage/json_splice.h"
#include "stage/stage_file.h"

namespace neuvv::stage {

namespace {

struct Source {
    std::string file;
    std::string folder;
    std::vector<uint8_t> bytes;
    bool binary = false;
    size_t json_begin = 0;
    size_t json_size = 0;
};

// tinygltf silently uses a default where a member has the wrong type, so types are checked here.
enum class Member { kIndex, kSize, kNumber, kNumbers };
struct MemberRule {
    const char* array;
    const char* name;
    Member kind;
};
constexpr MemberRule kRules[] = {
    {"accessors", "bufferView", Member::kIndex},
    {"accessors", "byteOffset", Member::kSize},
    {"accessors", "componentType", Member::kIndex},
    {"accessors", "count", Member::kSize},
    {"buffers", "byteLength", Member::kSize},
    {"bufferViews", "buffer", Member::kIndex},
    {"bufferViews", "byteOffset", Member::kSize},
    {"bufferViews", "byteLength", Member::kSize},
    {"bufferViews", "byteStride", Member::kSize},
    {"images", "bufferView", Member::kIndex},
    {"meshes", "weights", Member::kNumbers},
    {"nodes", "camera", Member::kIndex},
    {"nodes", "mesh", Member::kIndex},
    {"nodes", "skin", Member::kIndex},
    {"nodes", "children", Member::kNumbers},
    {"nodes", "matrix", Member::kNumbers},
    {"nodes", "translation", Member::kNumbers},
    {"nodes", "rotation", Member::kNumbers},
    {"nodes", "scale", Member::kNumbers},
    {"nodes", "weights", Member::kNumbers},
    {"skins", "inverseBindMatrices", Member::kIndex},
    {"skins", "joints", Member::kNumbers},
    {"scenes", "nodes", Member::kNumbers},
    {"textures", "source", Member::kIndex},
    {"textures", "sampler", Member::kIndex},
    {"materials", "alphaCutoff", Member::kNumber},
    {"samplers", "wrapS", Member::kIndex},
    {"samplers", "wrapT", Member::kIndex},
};

std::string type_problem(const nlohmann::json& value, Member kind) {
    const bool is_unsigned = value.is_number_unsigned();
    switch (kind) {
        case Member::kIndex:
            if (!is_unsigned || value.get<uint64_t>() > INT32_MAX) return "is not an index (a whole number from 0)";
            break;
        case Member::kSize:
            if (!is_unsigned || value.get<uint64_t>() > kMaxStageBytes)
                return fmt::format("is not a whole number from 0 to {}", kMaxStageBytes);
            break;
        case Member::kNumber:
            if (!value.is_number()) return "is not a number";
            break;
        case Member::kNumbers:
            if (!value.is_array()) return "is not a list of numbers";
            for (const nlohmann::json& item : value)
                if (!item.is_number()) return "is not a list of numbers";
            break;
    }
    return "";
}

void check_types(const Source& source, const nlohmann::json& root) {
    for (const auto& [name, array] : root.items()) {
        if (!array.is_array()) continue;
        const bool names = name == "extensionsUsed" || name == "extensionsRequired";
        for (size_t i = 0; i < array.size(); ++i)
            if (!(names ? array[i].is_string() : array[i].is_object()))
                throw InputError(source.file, fmt::format("/{}/{}", name, i),
                                 names ? "is not a string" : "is not an object");
    }
    if (root.contains("scene"))
        if (const std::string problem = type_problem(root["scene"], Member::kIndex); !problem.empty())
            throw InputError(source.file, "/scene", problem);
    for (const MemberRule& rule : kRules) {
        const auto array = root.find(rule.array);
        if (array == root.end()) continue;
        if (!array->is_array()) throw InputError(source.file, fmt::format("/{}", rule.array), "is not a list");
        for (size_t i = 0; i < array->size(); ++i) {
            const nlohmann::json& object = (*array)[i];
            const auto member = object.find(rule.name);
            if (member == object.end()) continue;
            const std::string problem = type_problem(*member, rule.kind);
            if (!problem.empty())
                throw InputError(source.file, fmt::format("/{}/{}/{}", rule.array, i, rule.name), problem);
        }
    }
}

// Checks types of materials' textures and factors, which are nested one level deeper.
void check_materials(const Source& source, const nlohmann::json& root) {
    const nlohmann::json none = nlohmann::json::array();
    const nlohmann::json& materials = root.contains("materials") ? root["materials"] : none;
    const auto expect = [&](const nlohmann::json& object, const std::string& place, const char* name, Member kind) {
        const auto member = object.find(name);
        if (member == object.end()) return;
        const std::string problem = type_problem(*member, kind);
        if (!problem.empty()) throw InputError(source.file, fmt::format("{}/{}", place, name), problem);
    };
    const auto textures = [&](const nlohmann::json& object, const std::string& place,
                              std::initializer_list<const char*> names) {
        for (const char* name : names) {
            if (!object.contains(name)) continue;
            const std::string at = fmt::format("{}/{}", place, name);
            if (!object[name].is_object()) throw InputError(source.file, at, "is not an object");
            for (const char* index : {"index", "texCoord"}) expect(object[name], at, index, Member::kIndex);
            for (const char* number : {"scale", "strength"}) expect(object[name], at, number, Member::kNumber);
        }
    };
    for (size_t i = 0; i < materials.size(); ++i) {
        const nlohmann::json& material = materials[i];
        const std::string place = fmt::format("/materials/{}", i);
        if (!material.is_object()) throw InputError(source.file, place, "is not an object");
        textures(material, place, {"normalTexture", "occlusionTexture", "emissiveTexture"});
        expect(material, place, "emissiveFactor", Member::kNumbers);
        if (!material.contains("pbrMetallicRoughness")) continue;
        const nlohmann::json& pbr = material["pbrMetallicRoughness"];
        const std::string in_pbr = place + "/pbrMetallicRoughness";
        if (!pbr.is_object()) throw InputError(source.file, in_pbr, "is not an object");
        textures(pbr, in_pbr, {"baseColorTexture", "metallicRoughnessTexture"});
        expect(pbr, in_pbr, "baseColorFactor", Member::kNumbers);
        for (const char* factor : {"metallicFactor", "roughnessFactor"}) expect(pbr, in_pbr, factor, Member::kNumber);
    }
}

// Whether a relative path may lead out of the folder. Percent escapes must have been decoded before (decoded_uri), so
// that %2e%2e is recognised as `..`.
bool leaves_folder(const std::string& relative) {
    const std::filesystem::path path(relative);
    if (relative.empty() || path.is_absolute() || relative.find('\0') != std::string::npos) return true;
    if (relative.find(':') != std::string::npos || relative.find('\\') != std::string::npos) return true;
    for (const auto& part : path)
        if (part == "..") return true;
    return false;
}

void check_uris(const Source& source, const nlohmann::json& root) {
    for (const char* name : {"buffers", "images"}) {
        const auto array = root.find(name);
        if (array == root.end()) continue;
        for (size_t i = 0; i < array->size(); ++i) {
            const auto uri = (*array)[i].find("uri");
            if (uri == (*array)[i].end()) continue;
            const std::string place = fmt::format("/{}/{}/uri", name, i);
            if (!uri->is_string()) throw InputError(source.file, place, "is not a string");
            const auto text = uri->get<std::string>();
            if (text.rfind("data:", 0) == 0) continue;
            if (leaves_folder(decoded_uri(text)))
                throw InputError(source.file, place, fmt::format("\"{}\" is not a file below the model's folder", text),
                                 "put the file beside the model and name it relatively");
        }
    }
}

void check_views(const Source& source, const nlohmann::json& root) {
    const nlohmann::json none = nlohmann::json::array();
    const nlohmann::json& buffers = root.contains("buffers") ? root["buffers"] : none;
    const nlohmann::json& views = root.contains("bufferViews") ? root["bufferViews"] : none;
    const nlohmann::json& images = root.contains("images") ? root["images"] : none;
    for (size_t i = 0; i < views.size(); ++i) {
        const std::string place = fmt::format("/bufferViews/{}", i);
        const nlohmann::json& view = views[i];
        if (!view.contains("buffer") || !view.contains("byteLength"))
            throw InputError(source.file, place, "lacks buffer or byteLength");
        const auto buffer = view["buffer"].get<uint64_t>();
        if (buffer >= buffers.size())
            throw InputError(source.file, place, fmt::format("buffer {} does not exist", buffer));
        const uint64_t end = view.value("byteOffset", uint64_t{0}) + view["byteLength"].get<uint64_t>();
        const uint64_t size = buffers[buffer].value("byteLength", uint64_t{0});
        if (end > size)
            throw InputError(source.file, place,
                             fmt::format("ends at byte {} of buffer {}, which has {}", end, buffer, size));
    }
    for (size_t i = 0; i < images.size(); ++i)
        if (images[i].contains("bufferView") && images[i]["bufferView"].get<uint64_t>() >= views.size())
            throw InputError(source.file, fmt::format("/images/{}/bufferView", i), "does not exist");
}

// Checks that the buffers' files exist and are long enough; tinygltf's message about a missing file says less.
void check_buffers(const Source& source, const nlohmann::json& root) {
    const nlohmann::json none = nlohmann::json::array();
    const nlohmann::json& buffers = root.contains("buffers") ? root["buffers"] : none;
    for (size_t i = 0; i < buffers.size(); ++i) {
        const std::string place = fmt::format("/buffers/{}/uri", i), uri = buffers[i].value("uri", "");
        if (uri.empty() || uri.starts_with("data:")) continue;
        const std::filesystem::path path = std::filesystem::path(source.folder) / decoded_uri(uri);
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error))
            throw InputError(source.file, place, fmt::format("\"{}\" does not exist", uri),
                             "put it beside the scene, or export the scene anew as a .glb");
        const uint64_t bytes = std::filesystem::file_size(path, error),
                       needed = buffers[i].value("byteLength", uint64_t{0});
        if (!error && bytes < needed)
            throw InputError(source.file, place, fmt::format("\"{}\" has {} bytes of {}", uri, bytes, needed),
                             "it is cut off, or of another export: export the scene again");
    }
}

void check_version(const Source& source, const nlohmann::json& root) {
    const nlohmann::json asset = root.value("asset", nlohmann::json::object());
    for (const char* name : {"version", "minVersion"}) {
        if (!asset.is_object() || !asset.contains(name)) continue;  // tinygltf refuses a file without "version"
        const std::string version = asset[name].is_string() ? asset[name].get<std::string>() : asset[name].dump();
        if (!version.starts_with("2."))
            throw InputError(source.file, fmt::format("/asset/{}", name),
                             fmt::format("is glTF {}, this program reads 2.0", version), "export it as glTF 2.0");
    }
}

// What an error message advises for a required extension that is unknown.
std::string fix_of_extension(const std::string& name) {
    for (const char* compression : {"draco", "meshopt", "basisu", "texture_webp", "texture_avif", "texture_dds"})
        if (name.find(compression) != std::string::npos)
            return "export without compression of meshes and textures, which this program does not read";
    return "export without it, or take it out of the list where the scene makes sense without";
}

void check_extensions(const Source& source, const nlohmann::json& root) {
    const auto required = root.find("extensionsRequired");
    if (required == root.end() || !required->is_array()) return;
    for (const nlohmann::json& extension : *required) {
        const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
        bool known = false;
        for (const char* ours : {"KHR_materials_unlit", "KHR_texture_transform", "KHR_mesh_quantization",
                                 "KHR_materials_emissive_strength", "KHR_lights_punctual", kVisibilityExtension,
                                 "NEUVV_performer", "NEUVV_stage"})
            known = known || name == ours;
        if (!known)
            throw InputError(source.file, "/extensionsRequired", fmt::format("needs {}, which is not supported", name),
                             fix_of_extension(name));
    }
}

void check_json(const Source& source) {
    const std::string_view text(reinterpret_cast<const char*>(source.bytes.data()) + source.json_begin,
                                source.json_size);
    expect_shallow_json(text, source.file);  // tinygltf walks extras and extensions recursively
    nlohmann::json root;
    try {
        root = nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        throw InputError(source.file, "", fmt::format("JSON: {}", error.what()));
    }
    if (!root.is_object())
        throw InputError(source.file, "", "is neither a .glb nor a JSON object", "give a glTF 2.0 file");
    check_version(source, root);
    check_types(source, root);
    check_materials(source, root);
    check_extensions(source, root);
    check_uris(source, root);
    check_views(source, root);
    check_buffers(source, root);
}

// Limits tinygltf's file access to the model's folder; by itself it would also search the working folder.
bool is_below(const std::string& path, const std::string& folder) {
    return path.rfind(folder + "/", 0) == 0 && !leaves_folder(path.substr(folder.size() + 1));
}

tinygltf::FsCallbacks folder_access(Source& source) {
    tinygltf::FsCallbacks callbacks{};
    callbacks.user_data = &source;
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.FileExists = [](const std::string& path, void* user) {
        std::error_code error;
        return is_below(path, static_cast<Source*>(user)->folder) && std::filesystem::is_regular_file(path, error);
    };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& path, void*) {
        try {
            *out = read_file(path, kMaxStageBytes);
            return true;
        } catch (const InputError& bad) {
            if (error) *error = bad.what();
            return false;
        }
    };
    return callbacks;
}

bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                  int size, void*) {
    if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
    return true;
}

}  // namespace

tinygltf::Model parse_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes) {
    Source source;
    source.file = path.string();
    source.folder = path.has_parent_path() ? path.parent_path().string() : ".";
    source.bytes = std::move(bytes);
    const GltfContainer container = find_gltf_json(source.bytes, source.file);
    source.binary = container.binary;
    source.json_begin = container.json_begin;
    source.json_size = container.json_size;
    check_json(source);

    tinygltf::Model model;
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(folder_access(source));
    loader.SetImageLoader(keep_encoded, nullptr);
    std::string problem, warning;
    bool ok = false;
    try {
        const auto size = static_cast<unsigned>(source.bytes.size());
        ok = source.binary
                 ? loader.LoadBinaryFromMemory(&model, &problem, &warning, source.bytes.data(), size, source.folder)
                 : loader.LoadASCIIFromString(&model, &problem, &warning,
                                              reinterpret_cast<const char*>(source.bytes.data()), size, source.folder);
    } catch (const std::exception& error) {
        problem = error.what();
    }
    // tinygltf drops what it cannot read and reports that in `problem`, even where it returns true.
    if (!ok || !problem.empty())
        throw InputError(source.file, "", problem.empty() ? "cannot be read as glTF" : problem);
    return model;
}

}  // namespace neuvv::stage
