#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/text.h"
#include "edit/document.h"
#include "edit/operations.h"
#include "media/image.h"

namespace neuvv::edit {

namespace {

constexpr float kFloorHalfSide = 5;                 // metres, of a new stage
constexpr uint32_t kSquare_px = 256, kLine_px = 4;  // of the image of a floor with lines
const glm::dvec3 kCameraPosition(0, 1.6, 4), kLightPosition(1.5, 4, 2.5), kCentre(0, 1, 0);
constexpr double kCandela = 60;

ordered_json rotation_json(const glm::dquat& q) {
    return {q.x, q.y, q.z, q.w};
}

// A square floor around a point, metres. With `squares`, lines divide it into so many squares along each side.
struct Floor {
    float half_side = kFloorHalfSide;
    glm::dvec3 centre{0};
    uint32_t squares = 0;
};

// One square of a floor: grey, with a brighter line along its edges.
std::string square_image() {
    media::Image image(kSquare_px, kSquare_px);
    for (uint32_t y = 0; y < kSquare_px; ++y)
        for (uint32_t x = 0; x < kSquare_px; ++x) {
            const uint32_t edge = std::min({x, y, kSquare_px - 1 - x, kSquare_px - 1 - y});
            const uint8_t grey = edge < kLine_px / 2 ? 150 : 96;
            const uint8_t pixel[] = {grey, grey, grey, 255};
            std::copy_n(pixel, 4, image.at(x, y));
        }
    return "data:image/png;base64," + base64(media::encode_png(image));
}

// Adds the floor's mesh: positions, normals, texture coordinates and indices, and the buffer that contains them.
void add_floor(ordered_json& json, const Floor& floor) {
    const float h = floor.half_side, u = static_cast<float>(floor.squares);
    const std::array<float, 32> vertices = {-h, 0, h, h, 0, h, h, 0, -h, -h, 0, -h, 0, 1, 0, 0,
                                            1,  0, 0, 1, 0, 0, 1, 0, 0,  u,  u, u,  u, 0, 0, 0};
    const std::array<uint16_t, 6> indices = {0, 1, 2, 0, 2, 3};
    std::vector<uint8_t> bytes(sizeof(vertices) + sizeof(indices));
    std::memcpy(bytes.data(), vertices.data(), sizeof(vertices));
    std::memcpy(bytes.data() + sizeof(vertices), indices.data(), sizeof(indices));
    ordered_json surface = {{"baseColorFactor", {0.5, 0.5, 0.5, 1.0}}, {"metallicFactor", 0}, {"roughnessFactor", 0.9}};
    ordered_json attributes = {{"POSITION", 0}, {"NORMAL", 1}};
    if (floor.squares > 0) {
        surface = {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}, {"roughnessFactor", 0.9}};
        attributes["TEXCOORD_0"] = 3;
        json["images"] = {{{"uri", square_image()}}};
        json["samplers"] = {{{"magFilter", 9729}, {"minFilter", 9987}}};
        json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    }
    json["materials"] = {{{"name", "floor"}, {"pbrMetallicRoughness", surface}, {"doubleSided", true}}};
    json["meshes"] = {
        {{"name", "floor"}, {"primitives", {{{"attributes", attributes}, {"indices", 2}, {"material", 0}}}}}};
    json["accessors"] = {{{"bufferView", 0},
                          {"componentType", 5126},
                          {"count", 4},
                          {"type", "VEC3"},
                          {"min", {-h, 0, -h}},
                          {"max", {h, 0, h}}},
                         {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                         {{"bufferView", 3}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}},
                         {{"bufferView", 2}, {"componentType", 5126}, {"count", 4}, {"type", "VEC2"}}};
    json["bufferViews"] = {{{"buffer", 0}, {"byteLength", 48}},
                           {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 48}},
                           {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 32}},
                           {{"buffer", 0}, {"byteOffset", 128}, {"byteLength", 12}}};
    json["buffers"] = {
        {{"byteLength", bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
}

// A stage with a floor and a spotlight "key" that shines from a point to another, but no camera.
ordered_json lit_floor(const Floor& floor, glm::dvec3 from, glm::dvec3 to, double candela) {
    ordered_json json = {{"asset", {{"version", "2.0"}, {"generator", "neuvv"}}},
                         {"extensionsUsed", {kLightsExtension, stage::kStageExtension}},
                         {"scene", 0}};
    json["scenes"] = {{{"name", "stage"},
                       {"nodes", {0, 1}},
                       {"extensions", {{stage::kStageExtension, {{"ambient", {0.3, 0.3, 0.3}}}}}}}};
    json["nodes"] = {{{"name", "floor"}, {"mesh", 0}},
                     {{"name", "key"},
                      {"translation", json_of(from)},
                      {"rotation", rotation_json(rotation_towards(to - from))},
                      {"extensions", {{kLightsExtension, {{"light", 0}}}}}}};
    if (floor.centre != glm::dvec3(0)) json["nodes"][0]["translation"] = json_of(floor.centre);
    json["extensions"] = {
        {kLightsExtension,
         {{"lights",
           {{{"name", "key"},
             {"type", "spot"},
             {"intensity", candela},
             {"spot", {{"innerConeAngle", std::numbers::pi / 8}, {"outerConeAngle", std::numbers::pi / 5}}}}}}}}};
    add_floor(json, floor);
    return json;
}

}  // namespace

stage::StageFile new_stage(const std::filesystem::path& path) {
    ordered_json json = lit_floor({}, kLightPosition, kCentre, kCandela);
    ordered_json camera = {{"name", "camera"},
                           {"camera", 0},
                           {"translation", json_of(kCameraPosition)},
                           {"rotation", rotation_json(rotation_towards(kCentre - kCameraPosition))}};
    json["nodes"].insert(json["nodes"].begin() + 1, std::move(camera));
    json["scenes"][0]["nodes"].push_back(2);
    json["cameras"] = {{{"name", "camera"},
                        {"type", "perspective"},
                        {"perspective", {{"yfov", std::numbers::pi / 4}, {"znear", 0.05}}}}};
    return stage::make_stage_file(path, json.dump(2) + "\n");
}

stage::StageFile stage_for_clip(const std::filesystem::path& path, glm::dvec3 low, glm::dvec3 high) {
    const glm::dvec3 size = high - low, centre = low + 0.5 * size;
    const double largest = std::max({size.x, size.y, size.z});
    // A person has squares of 1 m.
    const double square = std::pow(10.0, std::round(std::log10(largest / 2)));
    const auto squares = static_cast<uint32_t>(2 * std::ceil(2.5 * largest / square));
    const glm::dvec3 from = centre + largest * glm::dvec3(0.8, 1.6, 1.3);
    const double distance = glm::length(from - centre), usual = glm::length(kLightPosition - kCentre);
    ordered_json json = lit_floor({static_cast<float>(0.5 * squares * square), {centre.x, low.y, centre.z}, squares},
                                  from, centre, 2 * kCandela * distance * distance / (usual * usual));
    ordered_json& settings = json["scenes"][0]["extensions"][stage::kStageExtension];
    settings["falloff"] = false;  // the performer looks as it was filmed
    settings["background"] = {0.02, 0.022, 0.026};
    return stage::make_stage_file(path, json.dump(2) + "\n");
}

}  // namespace neuvv::edit
