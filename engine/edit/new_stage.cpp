#include <array>
#include <cstring>
#include <numbers>

#include "base/text.h"
#include "edit/document.h"
#include "edit/operations.h"

namespace neuvv::edit {

namespace {

constexpr float kFloorHalfSide = 5;  // metres
const glm::dvec3 kCameraPosition(0, 1.6, 4), kLightPosition(1.5, 4, 2.5), kMiddle(0, 1, 0);
constexpr double kCandela = 60;

ordered_json rotation_json(const glm::dquat& q) {
    return {q.x, q.y, q.z, q.w};
}

// Adds a square floor: positions, normals and indices, and the buffer that contains them.
void add_floor(ordered_json& json) {
    constexpr float h = kFloorHalfSide;
    const std::array<float, 24> vertices = {-h, 0, h, h, 0, h, h, 0, -h, -h, 0, -h, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0};
    const std::array<uint16_t, 6> indices = {0, 1, 2, 0, 2, 3};
    std::vector<uint8_t> bytes(sizeof(vertices) + sizeof(indices));
    std::memcpy(bytes.data(), vertices.data(), sizeof(vertices));
    std::memcpy(bytes.data() + sizeof(vertices), indices.data(), sizeof(indices));
    json["materials"] = {
        {{"name", "floor"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {0.5, 0.5, 0.5, 1.0}}, {"metallicFactor", 0}, {"roughnessFactor", 0.9}}},
         {"doubleSided", true}}};
    json["meshes"] = {
        {{"name", "floor"},
         {"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"material", 0}}}}}};
    json["accessors"] = {{{"bufferView", 0},
                          {"componentType", 5126},
                          {"count", 4},
                          {"type", "VEC3"},
                          {"min", {-h, 0, -h}},
                          {"max", {h, 0, h}}},
                         {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                         {{"bufferView", 2}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}};
    json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 48}},
                           {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 48}},
                           {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 12}}};
    json["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
}

}  // namespace

stage::StageFile new_stage(const std::filesystem::path& path) {
    ordered_json json = {{"asset", {{"version", "2.0"}, {"generator", "neuvv"}}},
                         {"extensionsUsed", {kLightsExtension, stage::kStageExtension}},
                         {"scene", 0}};
    json["scenes"] = {{{"name", "stage"},
                       {"nodes", {0, 1, 2}},
                       {"extensions", {{stage::kStageExtension, {{"ambient", {0.3, 0.3, 0.3}}}}}}}};
    json["nodes"] = {{{"name", "floor"}, {"mesh", 0}},
                     {{"name", "camera"},
                      {"camera", 0},
                      {"translation", json_of(kCameraPosition)},
                      {"rotation", rotation_json(rotation_towards(kMiddle - kCameraPosition))}},
                     {{"name", "key"},
                      {"translation", json_of(kLightPosition)},
                      {"rotation", rotation_json(rotation_towards(kMiddle - kLightPosition))},
                      {"extensions", {{kLightsExtension, {{"light", 0}}}}}}};
    json["cameras"] = {{{"name", "camera"},
                        {"type", "perspective"},
                        {"perspective", {{"yfov", std::numbers::pi / 4}, {"znear", 0.05}}}}};
    json["extensions"] = {
        {kLightsExtension,
         {{"lights",
           {{{"name", "key"},
             {"type", "spot"},
             {"intensity", kCandela},
             {"spot", {{"innerConeAngle", std::numbers::pi / 8}, {"outerConeAngle", std::numbers::pi / 5}}}}}}}}};
    add_floor(json);
    return stage::make_stage_file(path, json.dump(2) + "\n");
}

}  // namespace neuvv::edit
