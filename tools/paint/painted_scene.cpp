#include "tools/paint/painted_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "base/output_path.h"
#include "edit/operations.h"
#include "editor/open_file.h"
#include "interchange/camera/camera_path_file.h"
#include "render/volume/trace.h"
#include "tools/stage/stage_verbs.h"
#include "tools/view_path.h"
#include "voctree/files/clip.h"
#include "voctree/files/clip_box.h"
#include "voctree/files/nvpaint.h"
#include "voctree/files/occupied_box.h"

namespace neuvv::tools {

namespace {

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    const auto whole = [](const std::filesystem::path& path) {
        std::error_code error;
        const auto canonical = std::filesystem::weakly_canonical(std::filesystem::absolute(path), error);
        return error ? path : canonical;
    };
    return whole(a) == whole(b);
}

// Whether an entry of a performer's list is the painted layer.
bool is_painted(const stage::Stage& stage, const stage::PaintLayer& entry, const std::string& layer) {
    return is_same_file(stage::file_of_uri(stage.file, entry.uri, "paint"), layer);
}

StagedPerformer find_on_stage(const PaintOptions& options, PaintedScene::Use use) {
    StagedPerformer staged;
    staged.stage = stage::load_stage(options.scene);
    staged.index = find_performer(staged.stage, "--node", options.node);
    const std::vector<stage::PaintLayer>& list = staged.performer().settings.paint;
    while (staged.layer < list.size() && !is_painted(staged.stage, list[staged.layer], options.layer)) ++staged.layer;
    if (staged.layer == list.size() && use == PaintedScene::Use::kPaint) {
        prepare_output_file("scene", options.scene);
        stage::StageFile file = staged.stage.file;
        staged.change = edit::add_paint_layer(file, staged.performer().node, options.layer, {});
        staged.stage = stage::make_stage(std::move(file));
    }
    expect_time_on_stage(staged.stage, "--time", options.time_s.value_or(0));
    staged.evaluated = stage::stage_at(staged.stage, options.time_s.value_or(0));
    return staged;
}

// Nothing where the scene is a clip.
std::optional<StagedPerformer> open_stage(const PaintOptions& options, PaintedScene::Use use) {
    if (editor::has_stage_ending(options.scene)) return find_on_stage(options, use);
    if (!options.node.empty())
        throw InputError("--node", options.node, "is for stages", "leave it out: a .nvv is one performer");
    if (options.time_s)
        throw InputError("--time", fmt::format("{}", *options.time_s), "is for stages",
                         "choose --at, a frame of the clip");
    return std::nullopt;
}

// The camera of --key on the camera path.
stage::Camera path_camera(const PaintOptions& options, media::ImageSize size) {
    const stage::CameraPath path =
        interchange::read_camera_path(options.camera, 1, voctree::read_world_frame(options.scene));
    const uint32_t key = options.key.value_or(0);
    if (key >= path.keys.size())
        throw InputError(options.camera, fmt::format("frame {}", key), "is not there",
                         fmt::format("choose --key 0 to {}", path.keys.size() - 1));
    return stage::camera_at(path, path.keys[key].time_s, size.width, size.height);
}

// A camera on the orbit around a box, at an angle from its front.
stage::Camera orbit_camera(const std::pair<glm::dvec3, glm::dvec3>& box, double degrees, media::ImageSize size) {
    const glm::dvec3 centre = 0.5 * (box.first + box.second);
    stage::Camera camera = orbit_path(box, {{0, 0}, 25, 25}, size)[0].camera;
    const glm::dmat4 turned = glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 1, 0));
    camera.world_from_camera = glm::translate(glm::dmat4(1), centre) * turned * glm::translate(glm::dmat4(1), -centre) *
                               camera.world_from_camera;
    return camera;
}

// In the world: the camera of a path, a camera of the stage by name, one of the orbit, or the one of `neuvv render`.
stage::Camera stage_camera(const PaintOptions& options, const StagedPerformer& staged, media::ImageSize size) {
    if (names_camera_path(options.camera)) return path_camera(options, size);
    if (options.key) throw InputError("--key", fmt::format("{}", *options.key), "is for camera paths", "leave it out");
    const bool on_orbit = options.orbit_deg || (options.camera.empty() && !stage::has_camera(staged.evaluated));
    if (on_orbit)
        return orbit_camera(stage::performers_box(staged.stage, staged.evaluated), options.orbit_deg.value_or(0), size);
    return stage::camera_of(staged.stage, options.camera, staged.evaluated, size.width, size.height);
}

}  // namespace

PaintedScene::PaintedScene(const PaintOptions& options, Use what)
    : staged(open_stage(options, what)),
      use(what),
      clip(staged ? staged->stage.clips[staged->performer().clip].path
                  : voctree::clip_path(std::filesystem::path(options.scene))),
      index(voctree::read_clip_index(clip)) {
    voctree::expect_no_stream(clip);
    at = static_cast<float>(options.at.value_or(staged ? double{staged->evaluated_performer().frame} : 0));
    if (!(at >= 0 && at <= static_cast<float>(index.frames() - 1)))
        throw InputError("--at", fmt::format("{}", at), "is no frame of the clip",
                         fmt::format("choose 0 to {}", index.frames() - 1));
    std::error_code error;
    if (is_segmented()) {
        if (use == Use::kRead || std::filesystem::exists(options.layer, error))
            voctree::expect_paint_folder(options.layer);
        box = voctree::occupied_box(index);
        // Between two segments, the frame that a player shows.
        const voctree::SegmentFrame place = voctree::segment_frame(index, double{at});
        at = static_cast<float>(index.segments[place.segment].first) + place.frame;
    } else if (use == Use::kPaint) {
        prepare_output_file("layer", options.layer);
    }
}

PaintedSegment::PaintedSegment(const PaintedScene& scene, const PaintOptions& options, uint32_t number)
    : layer_file(scene.is_segmented() ? voctree::paint_file(options.layer, scene.index.segments[number])
                                      : std::filesystem::path(options.layer)),
      is_in_folder(scene.is_segmented()) {
    const voctree::ClipSegment& segment = scene.index.segments[number];
    clip = std::make_shared<const editor::PaintClip>(voctree::read_segment(segment));
    const bool is_new =
        !std::filesystem::exists(layer_file) && (scene.is_segmented() || scene.use == PaintedScene::Use::kPaint);
    layer = std::make_shared<voctree::EditLayer>(is_new ? voctree::EditLayer{clip->field, {}}
                                                        : voctree::read_paint(layer_file, clip->field));
    at = std::clamp(scene.at - static_cast<float>(segment.first), 0.0f, static_cast<float>(clip->tree.frames - 1));
    clip_box = scene.box ? *scene.box : voctree::occupied_box(clip->tree);
    if (scene.staged)
        read_other_layers(*scene.staged, options, scene.is_segmented() ? &segment : nullptr);
    else
        visible_.push_back({});
}

// `segment`: of a segmented clip.
void PaintedSegment::read_other_layers(const StagedPerformer& staged, const PaintOptions& options,
                                       const voctree::ClipSegment* segment) {
    for (const stage::PaintLayer& entry : staged.performer().settings.paint) {
        if (!entry.visible || entry.opacity <= 0) continue;
        editor::VisibleLayer& visible =
            visible_.emplace_back(editor::VisibleLayer{nullptr, entry.blend, static_cast<float>(entry.opacity)});
        if (is_painted(staged.stage, entry, options.layer)) continue;
        const std::filesystem::path path = stage::file_of_uri(staged.stage.file, entry.uri, staged.performer().name);
        if (segment) voctree::expect_paint_folder(path);
        visible.layer = std::make_shared<const voctree::EditLayer>(
            segment ? voctree::read_segment_paint(path, *segment, clip->field)
                    : voctree::read_paint(path, clip->field));
    }
}

editor::PaintSubject PaintedSegment::subject() const {
    editor::PaintSubject subject{.clip = clip, .frame = at, .paint = visible_};
    for (editor::VisibleLayer& visible : subject.paint)
        if (!visible.layer) visible.layer = layer;
    return subject;
}

void PaintedSegment::save() const {
    if (!is_in_folder) return voctree::write_paint(layer_file, *layer);
    if (!layer->edits.empty()) prepare_output_folder("layer", layer_file.parent_path());
    voctree::write_segment_paint(layer_file, *layer);
}

void PaintedScene::drop_new_layer() {
    if (!staged || staged->change.empty()) return;
    staged->change.clear();
    staged->layer = staged->performer().settings.paint.size();
}

// What others did to the stage meanwhile stays.
void PaintedScene::save_stage(const PaintOptions& options) const {
    if (!staged || staged->change.empty()) return;
    const EditLock lock(options.scene, says_that_it_waits(options.scene));
    stage::StageFile file = stage::read_stage_file(options.scene);
    if (file.saved->bytes == staged->stage.file.saved->bytes) {
        file = staged->stage.file;
    } else {
        const stage::StagePerformer& painted = staged->performer();
        const stage::Stage now = stage::make_stage(file);
        const std::string name = !options.node.empty() || painted.name.empty() ? options.node : painted.name;
        edit::add_paint_layer(file, now.performers[find_performer(now, "--node", name)].node, options.layer, {});
        stage::expect_sound_document(file);
    }
    stage::save_stage_file(file, options.scene);
}

media::ImageSize image_size(const PaintOptions& options, const PaintedScene& scene) {
    if (!options.size.empty()) return parse_size(options.size);
    if (scene.staged ? names_camera_path(options.camera) : !options.camera.empty()) {
        const stage::CameraPath path = interchange::read_camera_path(options.camera, 1);
        if (path.width > 0 && path.height > 0) return {path.width, path.height};
    }
    return scene.staged ? kStageSize : kClipSize;
}

stage::Camera camera_of(const PaintOptions& options, const PaintedScene& scene,
                        const std::pair<glm::dvec3, glm::dvec3>& clip_box, media::ImageSize size) {
    if (!scene.staged)
        return options.camera.empty() ? orbit_camera(clip_box, options.orbit_deg.value_or(0), size)
                                      : path_camera(options, size);
    const StagedPerformer& staged = *scene.staged;
    if (!stage::is_valid_transform(staged.evaluated_performer().world_from_performer))
        throw InputError(options.scene, fmt::format("/nodes/{}", staged.performer().node),
                         fmt::format("\"{}\" is flat, or out of this world, at {} s", staged.performer().name,
                                     staged.evaluated.time_s),
                         "choose another --time");
    return render::in_performer(stage_camera(options, staged, size),
                                glm::mat4(staged.evaluated_performer().world_from_performer));
}

}  // namespace neuvv::tools
