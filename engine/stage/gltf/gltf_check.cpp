#include "stage/gltf/gltf_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <span>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

namespace {

using Json = nlohmann::json;

// The root's lists, of strings where they name extensions and else of objects. `extras` may be anything.
constexpr const char* kLists[] = {
    "accessors",      "animations", "buffers",   "bufferViews", "cameras", "extensionsRequired",
    "extensionsUsed", "images",     "materials", "meshes",      "nodes",   "samplers",
    "scenes",         "skins",      "textures"};

// tinygltf silently uses a default where a member has the wrong type, and says little of one that is missing.
enum class Member { kIndex, kIndices, kSize, kNumber, kNumbers, kText, kObject, kList };
constexpr bool kNeeded = true;
// A member of the objects at a path, in which * stands for each element of a list.
struct MemberRule {
    const char* path;
    const char* name;
    Member kind;
    bool needed = false;
};
constexpr MemberRule kRules[] = {
    {"", "scene", Member::kIndex},
    {"accessors/*", "bufferView", Member::kIndex},
    {"accessors/*", "byteOffset", Member::kSize},
    {"accessors/*", "componentType", Member::kIndex, kNeeded},
    {"accessors/*", "count", Member::kSize, kNeeded},
    {"accessors/*", "type", Member::kText, kNeeded},
    {"accessors/*", "sparse", Member::kObject},
    {"accessors/*/sparse", "count", Member::kSize, kNeeded},
    {"accessors/*/sparse", "indices", Member::kObject, kNeeded},
    {"accessors/*/sparse", "values", Member::kObject, kNeeded},
    {"accessors/*/sparse/indices", "bufferView", Member::kIndex, kNeeded},
    {"accessors/*/sparse/indices", "byteOffset", Member::kSize},
    {"accessors/*/sparse/indices", "componentType", Member::kIndex, kNeeded},
    {"accessors/*/sparse/values", "bufferView", Member::kIndex, kNeeded},
    {"accessors/*/sparse/values", "byteOffset", Member::kSize},
    {"animations/*", "channels", Member::kList, kNeeded},
    {"animations/*", "samplers", Member::kList, kNeeded},
    {"animations/*/channels/*", "sampler", Member::kIndex, kNeeded},
    {"animations/*/channels/*", "target", Member::kObject, kNeeded},
    {"animations/*/channels/*/target", "node", Member::kIndex},
    {"animations/*/channels/*/target", "path", Member::kText, kNeeded},
    {"animations/*/samplers/*", "input", Member::kIndex, kNeeded},
    {"animations/*/samplers/*", "output", Member::kIndex, kNeeded},
    {"animations/*/samplers/*", "interpolation", Member::kText},
    {"buffers/*", "byteLength", Member::kSize, kNeeded},
    {"bufferViews/*", "buffer", Member::kIndex, kNeeded},
    {"bufferViews/*", "byteOffset", Member::kSize},
    {"bufferViews/*", "byteLength", Member::kSize, kNeeded},
    {"bufferViews/*", "byteStride", Member::kSize},
    {"cameras/*", "type", Member::kText, kNeeded},
    {"cameras/*/perspective", "yfov", Member::kNumber, kNeeded},
    {"cameras/*/perspective", "znear", Member::kNumber, kNeeded},
    {"cameras/*/orthographic", "xmag", Member::kNumber, kNeeded},
    {"cameras/*/orthographic", "ymag", Member::kNumber, kNeeded},
    {"cameras/*/orthographic", "zfar", Member::kNumber, kNeeded},
    {"cameras/*/orthographic", "znear", Member::kNumber, kNeeded},
    {"extensions", "KHR_lights_punctual", Member::kObject},
    {"extensions/KHR_lights_punctual", "lights", Member::kList},
    {"extensions/KHR_lights_punctual/lights/*", "type", Member::kText, kNeeded},
    {"images/*", "bufferView", Member::kIndex},
    {"images/*", "uri", Member::kText},
    {"meshes/*", "primitives", Member::kList, kNeeded},
    {"meshes/*", "weights", Member::kNumbers},
    {"meshes/*/primitives/*", "attributes", Member::kObject, kNeeded},
    {"meshes/*/primitives/*", "indices", Member::kIndex},
    {"meshes/*/primitives/*", "material", Member::kIndex},
    {"meshes/*/primitives/*", "mode", Member::kIndex},
    {"meshes/*/primitives/*", "targets", Member::kList},
    {"meshes/*/primitives/*/targets/*", "POSITION", Member::kIndex},
    {"nodes/*", "camera", Member::kIndex},
    {"nodes/*", "mesh", Member::kIndex},
    {"nodes/*", "skin", Member::kIndex},
    {"nodes/*", "children", Member::kIndices},
    {"nodes/*", "matrix", Member::kNumbers},
    {"nodes/*", "translation", Member::kNumbers},
    {"nodes/*", "rotation", Member::kNumbers},
    {"nodes/*", "scale", Member::kNumbers},
    {"nodes/*", "weights", Member::kNumbers},
    {"skins/*", "inverseBindMatrices", Member::kIndex},
    {"skins/*", "joints", Member::kIndices, kNeeded},
    {"scenes/*", "nodes", Member::kIndices},
    {"textures/*", "source", Member::kIndex},
    {"textures/*", "sampler", Member::kIndex},
    {"samplers/*", "wrapS", Member::kIndex},
    {"samplers/*", "wrapT", Member::kIndex},
    {"materials/*", "alphaCutoff", Member::kNumber},
    {"materials/*", "emissiveFactor", Member::kNumbers},
    {"materials/*", "pbrMetallicRoughness", Member::kObject},
    {"materials/*/pbrMetallicRoughness", "baseColorFactor", Member::kNumbers},
    {"materials/*/pbrMetallicRoughness", "metallicFactor", Member::kNumber},
    {"materials/*/pbrMetallicRoughness", "roughnessFactor", Member::kNumber},
};
// Of a material: the textures, and the members that they have.
constexpr std::array<std::array<const char*, 2>, 5> kMaterialTextures = {{
    {"materials/*", "normalTexture"},
    {"materials/*", "occlusionTexture"},
    {"materials/*", "emissiveTexture"},
    {"materials/*/pbrMetallicRoughness", "baseColorTexture"},
    {"materials/*/pbrMetallicRoughness", "metallicRoughnessTexture"},
}};
constexpr MemberRule kTextureRules[] = {
    {"", "index", Member::kIndex, kNeeded},
    {"", "texCoord", Member::kIndex},
    {"", "scale", Member::kNumber},
    {"", "strength", Member::kNumber},
};

std::string type_problem(const Json& value, Member kind) {
    const bool is_unsigned = value.is_number_unsigned();
    switch (kind) {
        case Member::kIndex:
            if (!is_unsigned || value.get<uint64_t>() > INT32_MAX) return "is not an index (a whole number from 0)";
            break;
        case Member::kIndices:
            if (!value.is_array()) return "is not a list of indices";
            for (const Json& item : value)
                if (!type_problem(item, Member::kIndex).empty()) return "is not a list of indices";
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
            for (const Json& item : value)
                if (!item.is_number()) return "is not a list of numbers";
            break;
        case Member::kText:
            if (!value.is_string()) return "is not a string";
            break;
        case Member::kObject:
            if (!value.is_object()) return "is not an object";
            break;
        case Member::kList:
            if (!value.is_array()) return "is not a list";
            break;
    }
    return "";
}

// Calls visit(object, place) for the objects at a path below `value`. Those that are missing are passed over.
template <typename Visit>
void for_objects(const std::string& file, const Json& value, const std::string& place,
                 std::span<const std::string> path, const Visit& visit) {
    if (path.empty()) {
        if (!value.is_object()) throw InputError(file, place, "is not an object");
        visit(value, place);
    } else if (path[0] == "*") {
        if (!value.is_array()) throw InputError(file, place, "is not a list");
        for (size_t i = 0; i < value.size(); ++i)
            for_objects(file, value[i], fmt::format("{}/{}", place, i), path.subspan(1), visit);
    } else if (path[0].empty()) {
        for_objects(file, value, place, path.subspan(1), visit);
    } else {
        if (!value.is_object()) throw InputError(file, place, "is not an object");
        if (const auto member = value.find(path[0]); member != value.end())
            for_objects(file, *member, place + "/" + path[0], path.subspan(1), visit);
    }
}

void check_rule(const std::string& file, const Json& root, const std::string& path, const MemberRule& rule) {
    const std::vector<std::string> parts = split(path, '/');
    for_objects(file, root, "", parts, [&](const Json& object, const std::string& place) {
        const auto member = object.find(rule.name);
        if (member == object.end() && rule.needed) throw InputError(file, place, fmt::format("lacks {}", rule.name));
        if (member == object.end()) return;
        if (const std::string problem = type_problem(*member, rule.kind); !problem.empty())
            throw InputError(file, fmt::format("{}/{}", place, rule.name), problem);
    });
}

void check_types(const std::string& file, const Json& root) {
    for (const char* name : kLists) {
        const auto list = root.find(name);
        if (list == root.end() || !list->is_array()) continue;
        const bool names = std::string_view(name).starts_with("extensions");
        for (size_t i = 0; i < list->size(); ++i)
            if (const Json& element = (*list)[i]; !(names ? element.is_string() : element.is_object()))
                throw InputError(file, fmt::format("/{}/{}", name, i), names ? "is not a string" : "is not an object");
    }
    for (const MemberRule& rule : kRules) check_rule(file, root, rule.path, rule);
    for (const auto& [path, texture] : kMaterialTextures)
        for (const MemberRule& rule : kTextureRules) check_rule(file, root, fmt::format("{}/{}", path, texture), rule);
}

// What an error message advises for a required extension that is unknown.
std::string fix_of_extension(const std::string& name) {
    for (const char* compression : {"draco", "meshopt", "basisu", "texture_webp", "texture_avif", "texture_dds"})
        if (name.find(compression) != std::string::npos)
            return "export without compression of meshes and textures, which this program does not read";
    return "export without it, or take it out of the list where the scene makes sense without";
}

// What has a type that is checked, but values that tinygltf refuses without saying where.
void check_values(const std::string& file, const Json& root) {
    const auto at = [&](const std::string& path, const auto& visit) {
        const std::vector<std::string> parts = split(path, '/');
        for_objects(file, root, "", parts, visit);
    };
    at("accessors/*", [&](const Json& accessor, const std::string& place) {
        constexpr std::array<const char*, 7> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
        const auto type = accessor["type"].get<std::string>();
        if (std::ranges::find(kTypes, type) == kTypes.end())
            throw InputError(file, place + "/type", fmt::format("\"{}\" is no type of elements", type));
        constexpr uint64_t kByte = 5120, kFloat = 5126;
        const auto component = accessor["componentType"].get<uint64_t>();
        if (component < kByte || component > kFloat)
            throw InputError(file, place + "/componentType", fmt::format("{} is none that glTF knows", component));
    });
    at("bufferViews/*", [&](const Json& view, const std::string& place) {
        const uint64_t stride = view.value("byteStride", uint64_t{0});
        if (stride > 252 || stride % 4 != 0)
            throw InputError(file, place + "/byteStride", fmt::format("{} is no multiple of 4 up to 252", stride));
    });
    at("cameras/*", [&](const Json& camera, const std::string& place) {
        const auto type = camera["type"].get<std::string>();
        if (type != "perspective" && type != "orthographic")
            throw InputError(file, place + "/type", "is neither perspective nor orthographic");
        if (!camera.contains(type)) throw InputError(file, place, "lacks " + type);
    });
    at("images/*", [&](const Json& image, const std::string& place) {
        if (!image.contains("uri") && !image.contains("bufferView"))
            throw InputError(file, place, "has neither uri nor bufferView");
    });
    const Json none = Json::array();
    const Json& accessors = root.contains("accessors") ? root["accessors"] : none;
    at("meshes/*/primitives/*", [&](const Json& primitive, const std::string& place) {
        for (const auto& [name, accessor] : primitive["attributes"].items())
            if (const std::string problem = type_problem(accessor, Member::kIndex); !problem.empty())
                throw InputError(file, fmt::format("{}/attributes/{}", place, name), problem);
        if (!primitive.contains("indices")) return;
        const auto index = primitive["indices"].get<size_t>();
        if (index >= accessors.size())
            throw InputError(file, place + "/indices", fmt::format("accessor {} does not exist", index));
        const Json extensions = primitive.value("extensions", Json::object());
        if (!accessors[index].contains("bufferView") && extensions.contains("KHR_draco_mesh_compression"))
            throw InputError(file, place, "is compressed by KHR_draco_mesh_compression", fix_of_extension("draco"));
    });
}

}  // namespace

std::string with_slashes(std::string path) {
    std::ranges::replace(path, '\\', '/');
    return path;
}

std::string path_of_uri(const std::string& uri) {
    return with_slashes(decoded_uri(uri));
}

bool leaves_folder(const std::string& relative) {
    const std::filesystem::path path(relative);
    if (relative.empty() || path.is_absolute() || relative.find('\0') != std::string::npos) return true;
    if (relative.find(':') != std::string::npos || relative.find('\\') != std::string::npos) return true;
    for (const auto& part : path)
        if (part == "..") return true;
    return false;
}

namespace {

void check_uris(const GltfPlace& source, const Json& root) {
    for (const char* name : {"buffers", "images"}) {
        const auto array = root.find(name);
        if (array == root.end()) continue;
        for (size_t i = 0; i < array->size(); ++i) {
            const auto uri = (*array)[i].find("uri");
            if (uri == (*array)[i].end()) continue;
            const std::string place = fmt::format("/{}/{}/uri", name, i);
            if (!uri->is_string()) throw InputError(source.file, place, "is not a string");
            const auto text = uri->get<std::string>();
            if (text.starts_with("data:")) {
                if (!bytes_of_data_uri(text)) throw InputError(source.file, place, "is no data URI in base64");
                continue;
            }
            if (leaves_folder(path_of_uri(text)))
                throw InputError(source.file, place, fmt::format("\"{}\" is not a file below the model's folder", text),
                                 "put the file beside the model and name it relatively");
        }
    }
}

void check_views(const GltfPlace& source, const Json& root) {
    const Json none = Json::array();
    const Json& buffers = root.contains("buffers") ? root["buffers"] : none;
    const Json& views = root.contains("bufferViews") ? root["bufferViews"] : none;
    const Json& images = root.contains("images") ? root["images"] : none;
    for (size_t i = 0; i < views.size(); ++i) {
        const std::string place = fmt::format("/bufferViews/{}", i);
        const Json& view = views[i];
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
void check_buffers(const GltfPlace& source, const Json& root) {
    const Json none = Json::array();
    const Json& buffers = root.contains("buffers") ? root["buffers"] : none;
    for (size_t i = 0; i < buffers.size(); ++i) {
        const std::string place = fmt::format("/buffers/{}/uri", i), uri = buffers[i].value("uri", "");
        if (uri.starts_with("data:")) {
            const uint64_t held = bytes_of_data_uri(uri).value_or(0),
                           wanted = buffers[i].value("byteLength", uint64_t{0});
            if (held < wanted)
                throw InputError(source.file, place, fmt::format("has {} bytes of {}", held, wanted),
                                 "it is cut off: export the scene again");
            continue;
        }
        if (uri.empty()) {
            const auto bytes = buffers[i].value("byteLength", uint64_t{0});
            if (!source.binary || i > 0)
                throw InputError(source.file, fmt::format("/buffers/{}", i), "lacks uri, and so has no bytes",
                                 "export the scene again");
            if (bytes > source.bin_size)
                throw InputError(source.file, "/buffers/0",
                                 fmt::format("has {} bytes, of which the .glb holds {}", bytes, source.bin_size),
                                 "export the .glb again");
            continue;
        }
        const std::filesystem::path path = std::filesystem::path(source.folder) / path_of_uri(uri);
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

void check_version(const GltfPlace& source, const Json& root) {
    const Json asset = root.value("asset", Json());
    if (!asset.is_object() || !asset.contains("version"))
        throw InputError(source.file, "/asset", "has no version", "give a glTF 2.0 file");
    for (const char* name : {"version", "minVersion"}) {
        if (!asset.contains(name)) continue;
        const std::string version = asset[name].is_string() ? asset[name].get<std::string>() : asset[name].dump();
        if (!version.starts_with("2."))
            throw InputError(source.file, fmt::format("/asset/{}", name),
                             fmt::format("is glTF {}, this program reads 2.0", version), "export it as glTF 2.0");
    }
}

void check_extensions(const GltfPlace& source, const Json& root) {
    const auto required = root.find("extensionsRequired");
    if (required == root.end() || !required->is_array()) return;
    for (const Json& extension : *required) {
        const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
        if (!is_read_extension(name))
            throw InputError(source.file, "/extensionsRequired", fmt::format("needs {}, which is not supported", name),
                             fix_of_extension(name));
    }
}

}  // namespace

std::optional<uint64_t> bytes_of_data_uri(std::string_view uri) {
    constexpr std::string_view kBase64 = ";base64";
    const size_t comma = uri.find(',');
    if (!uri.starts_with("data:") || comma == std::string_view::npos || !uri.substr(0, comma).ends_with(kBase64))
        return std::nullopt;
    const std::string_view digits = uri.substr(comma + 1);
    const auto is_digit = [](unsigned char c) { return std::isalnum(c) != 0 || c == '+' || c == '/'; };
    const auto count = static_cast<uint64_t>(std::ranges::find_if_not(digits, is_digit) - digits.begin());
    return count / 4 * 3 + count % 4 * 3 / 4;
}

bool is_read_extension(const std::string& name) {
    constexpr std::array<const char*, 9> kRead = {
        "KHR_materials_unlit", "KHR_texture_transform", "KHR_mesh_quantization", "KHR_materials_emissive_strength",
        "KHR_lights_punctual", kVisibilityExtension,    "NEUVV_performer",       "NEUVV_stage",
        "NEUVV_skeleton"};
    return std::ranges::find(kRead, name) != kRead.end();
}

void check_gltf(const Json& root, const GltfPlace& source) {
    check_version(source, root);
    check_types(source.file, root);
    check_extensions(source, root);
    check_uris(source, root);
    check_views(source, root);
    check_values(source.file, root);
    check_buffers(source, root);
}

}  // namespace neuvv::stage
