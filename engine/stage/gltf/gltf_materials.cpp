#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/error.h"
#include "base/platform.h"
#include "media/orientation.h"
#include "stage/gltf/gltf_parse.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

namespace {

// Limit on the decoded pixels of all images together, because a few bytes of PNG can decode to a gigabyte.
constexpr uint64_t kMaxImagePixels = uint64_t{1} << 28;

// Of a texture whose image is only in an extension that is not read, as EXT_texture_webp.
constexpr uint32_t kNoImage = UINT32_MAX;

GltfWrap wrap_mode(const GltfScene& scene, int value, const std::string& place) {
    switch (value) {
        case TINYGLTF_TEXTURE_WRAP_REPEAT:
            return GltfWrap::kRepeat;
        case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE:
            return GltfWrap::kClampToEdge;
        case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT:
            return GltfWrap::kMirroredRepeat;
        default:
            throw InputError(scene.file, place, fmt::format("{} is no wrapping mode", value));
    }
}

GltfTexture texture_of(const GltfScene& scene, const tinygltf::Model& model, size_t index) {
    const tinygltf::Texture& source = model.textures[index];
    const std::string place = fmt::format("/textures/{}", index);
    if (source.source >= static_cast<int>(model.images.size()))
        throw InputError(scene.file, place + "/source", "has no image of the model", "use PNG or JPEG textures");
    GltfTexture texture;
    texture.image = source.source < 0 ? kNoImage : static_cast<uint32_t>(source.source);
    if (source.sampler < 0) return texture;
    if (static_cast<size_t>(source.sampler) >= model.samplers.size())
        throw InputError(scene.file, place + "/sampler", fmt::format("{} does not exist", source.sampler));
    const tinygltf::Sampler& sampler = model.samplers[static_cast<size_t>(source.sampler)];
    const std::string sampler_place = fmt::format("/samplers/{}", source.sampler);
    texture.wrap_u = wrap_mode(scene, sampler.wrapS, sampler_place + "/wrapS");
    texture.wrap_v = wrap_mode(scene, sampler.wrapT, sampler_place + "/wrapT");
    texture.nearest_magnification = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST;
    const int filter = sampler.minFilter;
    texture.nearest_minification = filter == TINYGLTF_TEXTURE_FILTER_NEAREST ||
                                   filter == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST ||
                                   filter == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR;
    texture.mipmaps = filter != TINYGLTF_TEXTURE_FILTER_NEAREST && filter != TINYGLTF_TEXTURE_FILTER_LINEAR;
    return texture;
}

float number_in(const GltfScene& scene, double value, double low, double high, const std::string& place) {
    if (!(value >= low && value <= high))
        throw InputError(scene.file, place, fmt::format("{} is not from {} to {}", value, low, high));
    return static_cast<float>(value);
}

float number_at(const GltfScene& scene, const tinygltf::Value& value, const std::string& place) {
    const double number = value.IsNumber() ? value.GetNumberAsDouble() : NAN;
    return number_in(scene, number, -1e6, 1e6, place);
}

// KHR_texture_transform, and which UV set the texture uses. `Info` is tinygltf's TextureInfo, NormalTextureInfo or
// OcclusionTextureInfo.
template <typename Info>
TextureTransform transform_of(const GltfScene& scene, const Info& info, const std::string& place) {
    TextureTransform transform;
    transform.uv_set = info.texCoord;
    const auto found = info.extensions.find("KHR_texture_transform");
    if (found != info.extensions.end() && found->second.IsObject()) {
        const tinygltf::Value& extension = found->second;
        const auto pair = [&](const char* name, glm::vec2 fallback) {
            if (!extension.Has(name)) return fallback;
            const tinygltf::Value& list = extension.Get(name);
            const std::string at = place + "/extensions/KHR_texture_transform/" + name;
            if (!list.IsArray() || list.ArrayLen() != 2) throw InputError(scene.file, at, "is not a pair of numbers");
            return glm::vec2(number_at(scene, list.Get(0), at), number_at(scene, list.Get(1), at));
        };
        transform.offset = pair("offset", glm::vec2(0));
        transform.scale = pair("scale", glm::vec2(1));
        if (extension.Has("rotation")) transform.rotation = number_at(scene, extension.Get("rotation"), place);
        if (extension.Has("texCoord") && extension.Get("texCoord").IsInt())
            transform.uv_set = extension.Get("texCoord").GetNumberAsInt();
    }
    if (transform.uv_set < 0 || transform.uv_set > 7)
        throw InputError(scene.file, place + "/texCoord", fmt::format("{} is not from 0 to 7", transform.uv_set));
    return transform;
}

GltfAlpha alpha_mode(const GltfScene& scene, const std::string& mode, const std::string& place) {
    if (mode == "OPAQUE") return GltfAlpha::kOpaque;
    if (mode == "MASK") return GltfAlpha::kMask;
    if (mode == "BLEND") return GltfAlpha::kBlend;
    throw InputError(scene.file, place + "/alphaMode", "is not OPAQUE, MASK or BLEND");
}

// KHR_materials_emissive_strength
float emissive_strength(const GltfScene& scene, const tinygltf::Material& source, const std::string& place) {
    const auto found = source.extensions.find("KHR_materials_emissive_strength");
    if (found == source.extensions.end() || !found->second.IsObject() || !found->second.Has("emissiveStrength"))
        return 1;
    const std::string at = place + "/extensions/KHR_materials_emissive_strength/emissiveStrength";
    return number_in(scene, number_at(scene, found->second.Get("emissiveStrength"), at), 0, 1e6, at);
}

GltfMaterial material_of(const GltfScene& scene, const tinygltf::Material& source, const std::string& place) {
    GltfMaterial material;
    material.name = source.name;
    const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
    for (int c = 0; c < 4; ++c)
        material.base_color[c] = number_in(scene, pbr.baseColorFactor[static_cast<size_t>(c)], 0, 1,
                                           place + "/pbrMetallicRoughness/baseColorFactor");
    material.metallic = number_in(scene, pbr.metallicFactor, 0, 1, place + "/pbrMetallicRoughness/metallicFactor");
    material.roughness = number_in(scene, pbr.roughnessFactor, 0, 1, place + "/pbrMetallicRoughness/roughnessFactor");
    material.alpha = alpha_mode(scene, source.alphaMode, place);
    material.alpha_cutoff = number_in(scene, source.alphaCutoff, 0, 1e6, place + "/alphaCutoff");
    material.double_sided = source.doubleSided;
    material.unlit = source.extensions.contains("KHR_materials_unlit");
    material.normal_scale = number_in(scene, source.normalTexture.scale, -1e3, 1e3, place + "/normalTexture/scale");
    material.occlusion_strength =
        number_in(scene, source.occlusionTexture.strength, 0, 1, place + "/occlusionTexture/strength");
    const float strength = emissive_strength(scene, source, place);
    for (int c = 0; c < 3; ++c)
        material.emissive[c] =
            strength * number_in(scene, source.emissiveFactor[static_cast<size_t>(c)], 0, 1, place + "/emissiveFactor");
    return material;
}

// The index of the texture of one slot of a material (−1: none that is read), and the transform of its UVs.
template <typename Info>
int32_t read_texture(const GltfScene& scene, const Info& info, const std::string& place, TextureTransform& transform) {
    transform = transform_of(scene, info, place);
    if (info.index >= static_cast<int>(scene.textures.size()))
        throw InputError(scene.file, place + "/index", fmt::format("{} does not exist", info.index));
    const bool is_read = info.index >= 0 && scene.textures[static_cast<size_t>(info.index)].image != kNoImage;
    return is_read ? info.index : -1;
}

}  // namespace

std::vector<MaterialTransforms> load_materials(GltfScene& scene, const tinygltf::Model& model) {
    for (size_t i = 0; i < model.textures.size(); ++i) scene.textures.push_back(texture_of(scene, model, i));
    std::vector<MaterialTransforms> transforms;
    for (size_t i = 0; i < model.materials.size(); ++i) {
        const std::string place = fmt::format("/materials/{}", i);
        const tinygltf::Material& source = model.materials[i];
        GltfMaterial& material = scene.materials.emplace_back(material_of(scene, source, place));
        MaterialTransforms& transform = transforms.emplace_back();
        const tinygltf::PbrMetallicRoughness& pbr = source.pbrMetallicRoughness;
        const std::string in_pbr = place + "/pbrMetallicRoughness/";
        const auto read = [&](GltfMap map, const auto& info, const std::string& at) {
            const auto slot = static_cast<size_t>(map);
            material.maps[slot] = read_texture(scene, info, at, transform.maps[slot]);
        };
        material.texture = read_texture(scene, pbr.baseColorTexture, in_pbr + "baseColorTexture", transform.base);
        read(GltfMap::kMetallicRoughness, pbr.metallicRoughnessTexture, in_pbr + "metallicRoughnessTexture");
        read(GltfMap::kNormal, source.normalTexture, place + "/normalTexture");
        read(GltfMap::kOcclusion, source.occlusionTexture, place + "/occlusionTexture");
        read(GltfMap::kEmissive, source.emissiveTexture, place + "/emissiveTexture");
    }
    const auto without_image =
        std::ranges::count_if(scene.textures, [](const GltfTexture& texture) { return texture.image == kNoImage; });
    if (without_image > 0)
        scene.notes.push_back(fmt::format("leaves out {} of {} textures, which have no PNG or JPEG", without_image,
                                          scene.textures.size()));
    return transforms;
}

namespace {

std::span<const uint8_t> encoded_image(const GltfScene& scene, const tinygltf::Model& model, uint32_t index) {
    const tinygltf::Image& source = model.images[index];
    std::span<const uint8_t> bytes = source.image;
    if (source.bufferView >= 0) {
        const tinygltf::BufferView& view = model.bufferViews.at(static_cast<size_t>(source.bufferView));
        bytes = std::span(model.buffers.at(static_cast<size_t>(view.buffer)).data)
                    .subspan(view.byteOffset, view.byteLength);
    }
    if (bytes.empty())
        throw InputError(scene.file, fmt::format("/images/{}", index),
                         source.uri.empty() ? "has no bytes" : fmt::format("\"{}\" cannot be read", source.uri),
                         "put the image beside the model");
    return bytes;
}

std::shared_ptr<const GltfImage> load_image(const GltfScene& scene, const tinygltf::Model& model, uint32_t index,
                                            const GltfScene* before, uint64_t& pixels) {
    const std::span<const uint8_t> bytes = encoded_image(scene, model, index);
    const std::string name = fmt::format("{}: /images/{}", scene.file, index);
    const media::ImageSize size = media::image_header(bytes.data(), bytes.size(), name).stored;
    media::expect_content(size, bytes.size(), name);
    pixels += uint64_t{size.width} * size.height;
    if (pixels > kMaxImagePixels)
        throw InputError(scene.file, fmt::format("/images/{}", index), "the textures together are too large",
                         fmt::format("stay below {} pixels", kMaxImagePixels));
    if (before && index < before->images.size() && before->images[index] &&
        std::ranges::equal(before->images[index]->encoded, bytes))
        return before->images[index];
    return std::make_shared<const GltfImage>(
        GltfImage{{bytes.begin(), bytes.end()}, media::decode_image(bytes.data(), bytes.size(), name)});
}

}  // namespace

void load_images(GltfScene& scene, const tinygltf::Model& model, const GltfScene* before) {
    scene.images.resize(model.images.size());
    uint64_t pixels = 0;
    const auto load = [&](int32_t texture) {
        if (texture < 0) return;
        const uint32_t index = scene.textures[static_cast<size_t>(texture)].image;
        if (!scene.images[index]) scene.images[index] = load_image(scene, model, index, before, pixels);
    };
    for (const GltfMaterial& material : scene.materials) {
        load(material.texture);
        for (const int32_t texture : material.maps) load(texture);
    }
}

}  // namespace neuvv::stage
