#include "stage/gltf/gltf_mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <span>

#include "stage/file/stage_file.h"
#include "stage/gltf/gltf_check.h"

namespace neuvv::stage {

namespace {

using Json = nlohmann::json;

Json& list_of(Json& object, const char* name) {
    static Json none = Json::array();
    const auto found = object.find(name);
    return found == object.end() ? none : *found;
}

std::string title_of(const Json& object, const char* kind, size_t index) {
    const std::string name =
        object.contains("name") && object["name"].is_string() ? object["name"].get<std::string>() : "";
    return name.empty() ? fmt::format("{} {}", kind, index) : fmt::format("{} {} \"{}\"", kind, index, name);
}

void mend_channels(Json& root, MendedGltf& mended) {
    Json& animations = list_of(root, "animations");
    for (size_t a = 0; a < animations.size(); ++a) {
        Json kept = Json::array();
        size_t pointers = 0;
        for (const Json& channel : animations[a]["channels"]) {
            const Json& target = channel["target"];
            if (target.contains("node"))
                kept.push_back(channel);
            else
                pointers += target["path"] == "pointer" ? 1 : 0;
        }
        const size_t left_out = animations[a]["channels"].size() - kept.size();
        if (left_out == 0) continue;
        mended.changed = true;
        animations[a]["channels"] = std::move(kept);
        mended.notes.push_back(
            fmt::format("leaves out {} of the channels of {}, which move no node{}", left_out,
                        title_of(animations[a], "animation", a),
                        pointers > 0 ? fmt::format(" ({} by KHR_animation_pointer)", pointers) : ""));
    }
}

void mend_skins(Json& root, MendedGltf& mended) {
    for (Json& skin : list_of(root, "skins"))
        if (!skin.contains("inverseBindMatrices")) {
            skin["inverseBindMatrices"] = -1;
            mended.changed = true;
        }
}

void mend_lights(Json& root, MendedGltf& mended) {
    const Json::json_pointer place("/extensions/KHR_lights_punctual/lights");
    if (!root.contains(place)) return;
    for (Json& light : root[place])
        if (light["type"] == "spot" && !light.contains("spot")) {
            light["spot"] = Json::object();
            mended.changed = true;
        }
}

// Buffers of any media type are bytes, and images are known by their content.
void mend_data_uris(Json& root, MendedGltf& mended) {
    constexpr std::array<const char*, 4> kRead = {"data:application/octet-stream;base64,",
                                                  "data:application/gltf-buffer;base64,", "data:image/png;base64,",
                                                  "data:image/jpeg;base64,"};
    for (const char* array : {"buffers", "images"})
        for (Json& object : list_of(root, array)) {
            const std::string uri = object.value("uri", "");
            const auto is_read = [&](const char* header) { return uri.starts_with(header); };
            if (!uri.starts_with("data:") || std::ranges::any_of(kRead, is_read)) continue;
            object["uri"] = kRead[0] + uri.substr(uri.find(',') + 1);
            mended.changed = true;
        }
}

// What holds a buffer may be longer than it.
void mend_lengths(Json& root, const std::string& folder, MendedGltf& mended) {
    for (Json& buffer : list_of(root, "buffers")) {
        const std::string uri = buffer.value("uri", "");
        if (uri.empty()) continue;
        std::error_code error;
        uint64_t bytes = bytes_of_data_uri(uri).value_or(0);
        if (!uri.starts_with("data:"))
            bytes = std::filesystem::file_size(std::filesystem::path(folder) / path_of_uri(uri), error);
        if (error || bytes <= buffer.value("byteLength", uint64_t{0})) continue;
        buffer["byteLength"] = bytes;
        mended.changed = true;
    }
}

void mend_indices(Json& root, MendedGltf& mended) {
    for (Json& mesh : list_of(root, "meshes"))
        for (Json& primitive : mesh["primitives"]) {
            if (!primitive.contains("indices")) continue;
            if (root["accessors"][primitive["indices"].get<size_t>()].contains("bufferView")) continue;
            primitive["attributes"][kSparseIndices] = primitive["indices"];
            primitive.erase("indices");
            mended.changed = true;
        }
}

// Members that hold an index or a size, lists of indices, and objects of them.
constexpr std::array<const char*, 29> kWhole = {
    "buffer", "bufferView", "byteLength", "byteOffset", "byteStride", "camera",   "componentType", "count",
    "index",  "indices",    "input",      "light",      "magFilter",  "material", "mesh",          "minFilter",
    "mode",   "node",       "output",     "sampler",    "scene",      "skin",     "source",        "texCoord",
    "NORMAL", "POSITION",   "TANGENT",    "wrapS",      "wrapT"};
constexpr std::array<const char*, 4> kWholeInside = {"attributes", "children", "joints", "nodes"};

bool is_one_of(std::span<const char* const> names, const std::string& name) {
    return std::ranges::any_of(names, [&](const char* each) { return name == each; });
}

bool make_whole(Json& value) {
    constexpr double kMost = uint64_t{1} << 53;
    if (!value.is_number_float()) return false;
    const auto number = value.get<double>();
    if (!(number >= 0 && number <= kMost) || std::floor(number) != number) return false;
    value = static_cast<uint64_t>(number);
    return true;
}

}  // namespace

bool mend_whole_numbers(Json& root) {
    bool changed = false;
    if (!root.is_structured()) return false;
    for (auto item = root.begin(); item != root.end(); ++item) {
        const std::string name = root.is_object() ? item.key() : "";
        if (name == "extras") continue;
        if (is_one_of(kWhole, name) || name == "inverseBindMatrices") changed |= make_whole(*item);
        if (is_one_of(kWholeInside, name) && item->is_structured())
            for (Json& element : *item) changed |= make_whole(element);
        changed |= mend_whole_numbers(*item);
    }
    return changed;
}

MendedGltf mend_gltf(Json& root, const std::string& folder) {
    MendedGltf mended;
    mend_channels(root, mended);
    mend_skins(root, mended);
    mend_lights(root, mended);
    mend_data_uris(root, mended);
    mend_lengths(root, folder, mended);
    mend_indices(root, mended);
    std::string unread;
    for (const Json& extension : list_of(root, "extensionsUsed"))
        if (!is_read_extension(extension.get<std::string>()))
            unread += (unread.empty() ? "" : ", ") + extension.get<std::string>();
    if (!unread.empty()) mended.notes.push_back("does not read " + unread);
    return mended;
}

}  // namespace neuvv::stage
