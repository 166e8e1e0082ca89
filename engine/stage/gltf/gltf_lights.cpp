#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "stage/gltf/gltf_parse.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

namespace {

constexpr const char* kExtension = "KHR_lights_punctual";
constexpr const char* kLightsPlace = "/extensions/KHR_lights_punctual/lights";

// The member `name`, which must be a number from `low` to `high`, or `otherwise` where it is missing. tinygltf itself
// treats a member of another type as missing.
double number(const GltfScene& scene, const tinygltf::Value& object, const std::string& place, const char* name,
              double low, double high, double otherwise) {
    if (!object.Has(name)) return otherwise;
    const tinygltf::Value& value = object.Get(name);
    const double found = value.IsNumber() ? value.GetNumberAsDouble() : NAN;
    if (!(found >= low && found <= high))
        throw InputError(scene.file, place + "/" + name, fmt::format("is no number from {} to {}", low, high));
    return found;
}

GltfLightKind kind_of(const GltfScene& scene, const tinygltf::Value& source, const std::string& place) {
    const std::string type =
        source.Has("type") && source.Get("type").IsString() ? source.Get("type").Get<std::string>() : "";
    if (type == "directional") return GltfLightKind::kDirectional;
    if (type == "point") return GltfLightKind::kPoint;
    if (type == "spot") return GltfLightKind::kSpot;
    throw InputError(scene.file, place + "/type", "is not directional, point or spot");
}

GltfLight light_of(const GltfScene& scene, const tinygltf::Value& source, const std::string& place) {
    if (!source.IsObject()) throw InputError(scene.file, place, "is not an object");
    GltfLight light;
    if (source.Has("name") && source.Get("name").IsString()) light.name = source.Get("name").Get<std::string>();
    light.kind = kind_of(scene, source, place);
    if (source.Has("color")) {
        const tinygltf::Value& color = source.Get("color");
        const bool whole = color.IsArray() && color.ArrayLen() == 3;
        for (int i = 0; i < 3; ++i) {
            const double part = whole && color.Get(i).IsNumber() ? color.Get(i).GetNumberAsDouble() : NAN;
            if (!(part >= 0 && part <= 1e6))
                throw InputError(scene.file, place + "/color", "is not three numbers from 0");
            light.color[i] = part;
        }
    }
    light.intensity = number(scene, source, place, "intensity", 0, 1e9, 1);
    light.range_m = number(scene, source, place, "range", 1e-6, 1e9, 0);
    if (light.kind != GltfLightKind::kSpot) return light;
    const std::string at = place + "/spot";
    const tinygltf::Value& spot = source.Get("spot");  // tinygltf checks that it exists, and reads {} as null
    light.outer_cone_rad =
        number(scene, spot, at, "outerConeAngle", 1e-4, std::numbers::pi / 2 + 1e-6, std::numbers::pi / 4);
    light.inner_cone_rad = number(scene, spot, at, "innerConeAngle", 0, std::numbers::pi / 2 + 1e-6, 0);
    if (light.inner_cone_rad >= light.outer_cone_rad)
        throw InputError(scene.file, at, "innerConeAngle is not below outerConeAngle");
    return light;
}

}  // namespace

void load_lights(GltfScene& scene, const tinygltf::Model& model) {
    const auto extension = model.extensions.find(kExtension);
    if (extension != model.extensions.end() && extension->second.Has("lights")) {
        const tinygltf::Value& lights = extension->second.Get("lights");
        if (!lights.IsArray()) throw InputError(scene.file, kLightsPlace, "is not a list");
        for (size_t i = 0; i < lights.ArrayLen(); ++i)
            scene.lights.push_back(
                light_of(scene, lights.Get(static_cast<int>(i)), fmt::format("{}/{}", kLightsPlace, i)));
    }
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const auto used = model.nodes[i].extensions.find(kExtension);
        if (used == model.nodes[i].extensions.end()) continue;
        const std::string place = fmt::format("/nodes/{}/extensions/{}/light", i, kExtension);
        const tinygltf::Value light = used->second.Has("light") ? used->second.Get("light") : tinygltf::Value();
        if (!light.IsInt() || light.GetNumberAsInt() < 0 ||
            static_cast<size_t>(light.GetNumberAsInt()) >= scene.lights.size())
            throw InputError(scene.file, place, "is not the index of a light");
        scene.nodes[i].light = light.GetNumberAsInt();
    }
}

}  // namespace neuvv::stage
