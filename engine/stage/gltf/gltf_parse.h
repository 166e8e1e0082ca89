// Internal to this module: checks the bytes of a glTF file, then parses them with tinygltf.
#pragma once

// These must be as in third_party/tinygltf.cpp, because the layout of tinygltf's class depends on them.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_JSON
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

// Guarantees more than tinygltf does: the container is complete, JSON nests at most kMaxJsonNesting (json_splice.h)
// deep, the integers and lists of numbers that this module reads have these types, every buffer view lies inside its
// buffer, and URIs stay below the file's folder. Throws InputError with the JSON location otherwise. Images of files
// and data URIs are left encoded in Image::image; images in buffer views are not copied.
struct ParsedGltf {
    tinygltf::Model model;
    std::vector<std::string> notes;  // what is left out
};
ParsedGltf parse_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes);

// What the functions below read accessors from; they check every bound.
struct AccessorReader {
    const std::string& file;
    const tinygltf::Model& model;
    // Components that may still be decoded: accessors may overlap, so a small file could otherwise ask for any amount.
    uint64_t budget = uint64_t{1} << 26;
};

// Reads all elements of an accessor. `user` is the location in the JSON that refers to it, for error messages. Integers
// are divided by the largest value of their type where the accessor is `normalized`. The result is count × components
// finite numbers. Throws InputError.
std::vector<float> read_floats(AccessorReader& reader, int accessor, int components, const std::string& user);
// The same for unsigned integers of 8, 16 or 32 bits. Throws InputError for floats and signed integers, too.
std::vector<uint32_t> read_integers(AccessorReader& reader, int accessor, int components, const std::string& user);
// The number of components of the accessor's type (VEC3: 3, MAT4: 16). Throws InputError for an index out of range.
int accessor_components(const AccessorReader& reader, int accessor, const std::string& user);
// True for integers that are not normalised, which glTF forbids for colours and weights.
bool is_raw_integer(const AccessorReader& reader, int accessor);

// KHR_texture_transform of one texture of a material; the rotation is in radians.
struct TextureTransform {
    int uv_set = 0;
    glm::vec2 offset{0};
    glm::vec2 scale{1};
    float rotation = 0;
};
// The transforms of one material's textures.
struct MaterialTransforms {
    TextureTransform base;                         // of the base colour
    std::array<TextureTransform, kGltfMaps> maps;  // of the other textures, indexed by GltfMap
};

// The steps of load_gltf, nearly in the order in which they run: images are loaded last. Each fills its part of the
// scene and throws InputError for what it refuses.
std::vector<MaterialTransforms> load_materials(GltfScene& scene, const tinygltf::Model& model);
void load_images(GltfScene& scene, const tinygltf::Model& model, const GltfScene* before);
void load_meshes(GltfScene& scene, AccessorReader& reader, const std::vector<MaterialTransforms>& transforms);
void load_skins(GltfScene& scene, AccessorReader& reader);
void load_nodes(GltfScene& scene, const tinygltf::Model& model);
void load_animations(GltfScene& scene, AccessorReader& reader);
void load_cameras(GltfScene& scene, const tinygltf::Model& model);
void load_lights(GltfScene& scene, const tinygltf::Model& model);

}  // namespace neuvv::stage
