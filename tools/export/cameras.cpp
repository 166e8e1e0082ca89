// Cameras of stages as paths of other programs.
#include <fmt/format.h>

#include "base/error.h"
#include "base/output_path.h"
#include "interchange/camera/camera_path_file.h"
#include "interchange/stage/camera_gltf.h"
#include "interchange/stage/camera_usd.h"
#include "stage/evaluated_stage.h"
#include "tools/export/stage_kinds.h"
#include "tools/options.h"
#include "tools/results.h"
#include "tools/view_path.h"

namespace neuvv::tools {

namespace {

struct ExportedCamera {
    stage::CameraPath path, images;  // in the capture's coordinates, but for glTF, which has floats
    std::string text() const {
        return fmt::format("{} images of {}x{}, {:.6g} a second", images.keys.size(), images.width, images.height,
                           images.fps);
    }
};

ExportedCamera camera_of(const ExportOptions& options) {
    const bool has_floats = std::filesystem::path(options.output).extension() == ".glb";
    const stage::Stage stage = stage::load_stage(options.scene);
    const double fps = options.fps.value_or(stage.fps);
    ExportedCamera camera;
    if (names_camera_path(options.camera))
        camera.path = interchange::read_camera_path(options.camera, fps, interchange::frame_of(stage));
    else if (stage.settings.camera_path && (options.camera.empty() || options.camera == kStagePath))
        camera.path = *stage.settings.camera_path;
    else
        camera.path = stage::path_of_camera(stage, options.camera, fps);
    const media::ImageSize size = options.size.empty() ? kStageSize : parse_size(options.size);
    camera.images = stage::by_images(camera.path, fps, size.width, size.height);
    if (!has_floats) {
        camera.path = interchange::in_capture(camera.path, interchange::frame_of(stage));
        camera.images = interchange::in_capture(camera.images, interchange::frame_of(stage));
    }
    prepare_result("--output", options.output);
    return camera;
}

std::string write_camera(const ExportOptions& options, const CommonOptions&, nlohmann::ordered_json&) {
    const ExportedCamera camera = camera_of(options);
    if (std::filesystem::path(options.output).extension() == ".usda") {
        interchange::write_camera_usda(options.output, camera.images);
        return camera.text();
    }
    interchange::write_camera_glb(options.output, camera.images);
    double low = camera.images.keys[0].angle_y, high = low, shift = 0;
    for (const stage::CameraPathKey& key : camera.images.keys) {
        low = std::min(low, key.angle_y);
        high = std::max(high, key.angle_y);
        shift = std::max(shift, glm::length(key.shift));
    }
    std::string text = camera.text();
    if (high - low >= 1e-6)
        text += fmt::format("; glTF has one angle of view: {:.1f}° in place of {:.1f}° to {:.1f}°",
                            glm::degrees(camera.images.keys[0].angle_y), glm::degrees(low), glm::degrees(high));
    if (shift >= 1e-6) text += "; glTF has no shift of the lens";
    return text;
}

std::string write_nerfstudio(const ExportOptions& options, const CommonOptions&, nlohmann::ordered_json&) {
    const ExportedCamera camera = camera_of(options);
    interchange::write_nerfstudio_path(options.output, camera.path, camera.images, options.world);
    return camera.text();
}

std::string write_ngp(const ExportOptions& options, const CommonOptions&, nlohmann::ordered_json&) {
    const ExportedCamera camera = camera_of(options);
    interchange::write_ngp_path(options.output, camera.images, options.world);
    return camera.text();
}

}  // namespace

const std::vector<StageKind>& stage_kinds() {
    static const std::vector<StageKind> kinds = {
        {"camera", {".usda", ".glb"}, {"--camera", "--fps", "--size"}, write_camera},
        {"layout", {".usda"}, {"--fps", "--splats"}, write_layout},
        {"nerfstudio", {".json"}, {"--camera", "--fps", "--size", "--world"}, write_nerfstudio},
        {"instant-ngp", {".json"}, {"--camera", "--fps", "--size", "--world"}, write_ngp},
        {"stand-ins", {".glb"}, {"--most-splats", "--time", "--views", "--size"}, write_stage_with_splats},
        {"web", {}, {"--rate", "--quality", "--group"}, write_web_stage},
    };
    return kinds;
}

}  // namespace neuvv::tools
