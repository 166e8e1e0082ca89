#include <fmt/format.h>

#include <numbers>

#include "base/error.h"
#include "stage/gltf/gltf_parse.h"
#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

void load_cameras(GltfScene& scene, const tinygltf::Model& model) {
    for (size_t i = 0; i < model.cameras.size(); ++i) {
        const tinygltf::Camera& source = model.cameras[i];
        GltfCamera camera;
        camera.name = source.name;
        camera.orthographic = source.type == "orthographic";
        if (!camera.orthographic) {
            camera.vertical_angle_rad = source.perspective.yfov;
            if (!(camera.vertical_angle_rad > 1e-3 && camera.vertical_angle_rad < std::numbers::pi - 1e-3))
                throw InputError(scene.file, fmt::format("/cameras/{}/perspective/yfov", i),
                                 fmt::format("{} is no angle of view between 0 and π", camera.vertical_angle_rad));
        }
        scene.cameras.push_back(std::move(camera));
    }
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        const int camera = model.nodes[i].camera;
        if (camera < 0) continue;
        if (static_cast<size_t>(camera) >= scene.cameras.size())
            throw InputError(scene.file, fmt::format("/nodes/{}/camera", i), fmt::format("{} does not exist", camera));
        scene.nodes[i].camera = camera;
    }
}

}  // namespace neuvv::stage
