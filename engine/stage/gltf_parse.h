// For this module alone: the checked hand-over from bytes to tinygltf's model.
#pragma once

// As in third_party/tinygltf.cpp: the class's layout depends on them.
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

#include "stage/gltf_scene.h"

namespace neuvv::stage {

// Promises beyond tinygltf's: the container is whole, JSON nests at most kMaxJsonNesting (json_splice.h) deep, integers
// and number lists that we read are of that type, every buffer view lies inside its buffer, URIs stay in the file's
// folder. Images of files and data URIs are left encoded in Image::image; those in buffer views are not copied.
tinygltf::Model parse_gltf(const std::filesystem::path& path, std::vector<uint8_t> bytes);

// Accessors, read with every bound checked.
struct AccessorReader {
    const std::string& file;
    const tinygltf::Model& model;
    // Components that may still be decoded: accessors may overlap, so a small file could otherwise ask for any amount.
    uint64_t budget = uint64_t{1} << 26;
};

// `user` is the JSON place that refers to the accessor. Integers are divided by their range where the accessor is
// `normalized`. Values are finite; the result holds count × components.
std::vector<float> read_floats(AccessorReader& reader, int accessor, int components, const std::string& user);
// Unsigned integers of 8, 16 or 32 bits; floats and signed ones are refused.
std::vector<uint32_t> read_integers(AccessorReader& reader, int accessor, int components, const std::string& user);
// Components of the accessor's type (VEC3: 3, MAT4: 16), after checking the index.
int accessor_components(const AccessorReader& reader, int accessor, const std::string& user);
// True for integers that are not normalised, which glTF forbids for colours, UVs and weights.
bool is_raw_integer(const AccessorReader& reader, int accessor);

// The steps of load_gltf, in the order they run; each fills its part of the scene.
struct TextureTransform {
    int uv_set = 0;
    glm::vec2 offset{0};
    glm::vec2 scale{1};
    float rotation = 0;
};
// The transforms of one material's textures: the base colour's and, by GltfMap, the others'.
struct MaterialTransforms {
    TextureTransform base;
    std::array<TextureTransform, kGltfMaps> maps;
};
std::vector<MaterialTransforms> load_materials(GltfScene& scene, const tinygltf::Model& model);
void load_images(GltfScene& scene, const tinygltf::Model& model, const GltfScene* before);
void load_meshes(GltfScene& scene, AccessorReader& reader, const std::vector<MaterialTransforms>& transforms);
void load_skins(GltfScene& scene, AccessorReader& reader);
void load_nodes(GltfScene& scene, const tinygltf::Model& model);
void load_animations(GltfScene& scene, AccessorReader& reader);
void load_cameras(GltfScene& scene, const tinygltf::Model& model);
void load_lights(GltfScene& scene, const tinygltf::Model& model);

}  // namespace neuvv::stage
