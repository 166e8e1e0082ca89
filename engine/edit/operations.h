// The operations on a stage, the same for mouse, controller and script.
//
// Each operation changes the JSON of a StageFile and nothing else, and returns a short line about what changed. It
// expects a sound document (expect_sound_document). Where it cannot be done, it throws InputError and changes nothing.
// Whether the given numbers are valid is checked when the document is saved, by expect_sound_document again. Members of
// the JSON that an operation does not know are kept.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "edit/read.h"

namespace neuvv::edit {

constexpr uint32_t kMaxCopies = 511;

// A new stage that is not on the disk yet: a floor, a camera "camera", a spotlight "key" and a little ambient light.
stage::StageFile new_stage(const std::filesystem::path& path);
// A new stage that is not on the disk yet, to look at a clip whose leaves lie in this box (metres, +Y up): a floor
// with lines under it and a spotlight that casts its shadow. The performer itself is not added.
stage::StageFile stage_for_clip(const std::filesystem::path& path, glm::dvec3 low, glm::dvec3 high);

// How place_node changes the transform of a node: in the space of the node's parent, metres and degrees. The members
// apply in this order.
struct Placement {
    std::optional<glm::dmat4> matrix;  // replaces the transform
    // The same for a drag: a node that has translation, rotation and scale keeps that form, unless the matrix is
    // sheared.
    std::optional<glm::dmat4> to;
    std::optional<glm::dvec3> at, move;
    std::optional<glm::dvec3> turn_deg;  // about the parent's X, then Y, then Z, at the node's position
    std::optional<glm::dvec3> scale;     // factors along its own axes
    std::optional<glm::dvec3> aim;       // the point that its −Z points to
};
std::string place_node(stage::StageFile& file, uint32_t node, const Placement& placement);
// Renames a node; a number is appended where another node has the name.
std::string rename_node(stage::StageFile& file, uint32_t node, const std::string& name);

struct PerformerEdit {
    std::optional<std::filesystem::path> clip;  // path of a .nvv
    std::optional<stage::TimeMap> time;
    std::optional<double> spin_deg_per_s, opacity;
    std::optional<bool> visible, casts_shadow, receives_shadow;
    std::optional<std::filesystem::path> skeleton;  // of a .skeleton.glb; empty: the file beside the .nvv
    std::optional<std::filesystem::path> sound;     // a file with a sound, or its address; empty: none
    std::optional<double> gain_db;                  // of a sound that is there or given here
};
// Adds a performer on a node of its own at the end of the scene. An empty name stands for the clip's file name. Where
// no sound is given and the clip has one beside it (voctree::sound_beside), that is the performer's; the server of a
// stream is asked for it.
std::string add_performer(stage::StageFile& file, const std::string& name, const PerformerEdit& edit,
                          const Placement& placement);
std::string set_performer(stage::StageFile& file, uint32_t node, const PerformerEdit& edit);

// Shows or hides a node and all nodes below it by KHR_node_visibility: meshes, lights and performers, but not cameras.
// Showing a performer also removes its own `visible`, so that it is seen.
std::string show_node(stage::StageFile& file, uint32_t node, bool visible);
// Locks a node for programs in which users could move it by mistake (extras.neuvv.locked). Operations ignore the lock.
std::string lock_node(stage::StageFile& file, uint32_t node, bool locked);

struct StageEdit {
    std::optional<double> duration_s, fps;
    std::optional<glm::dvec3> background, ambient;
    std::optional<std::filesystem::path> environment;  // an image; empty: no environment
    std::optional<double> environment_intensity, environment_rotation_deg;
    std::optional<stage::StageBlend> blend;
    std::optional<bool> shadows, falloff;
};
std::string set_stage(stage::StageFile& file, const StageEdit& edit);

// Copies of a node and all nodes below it. The node itself stays where it is, as the first of the pattern: of a row
// along +X; of a ring on which all face outwards (the node's front is +Z, so the centre lies behind it); or of an arc
// of such a ring whose last copy stands arc_deg further on, counter-clockwise as seen from above. Copies share meshes,
// lights and clips.
enum class CopyPattern { kRow, kRing, kFan };
struct CopySettings {
    uint32_t count = 1;  // of copies, 1 to kMaxCopies
    CopyPattern pattern = CopyPattern::kRow;
    double distance_m = 1;    // between neighbours of a row, or the radius of a ring or fan
    double arc_deg = 90;      // of a fan
    stage::ClipTime stagger;  // later than the copy before; endless maps still run from the start
    double spin_step = 0;     // each copy spins faster by this, degrees per second
};
std::string duplicate_node(stage::StageFile& file, uint32_t node, const CopySettings& settings);
// Where duplicate_node puts the copies: the transform of each in the space of the node's parent, metres. No copies
// where it would refuse their number.
std::vector<glm::dmat4> copy_transforms(const stage::StageFile& file, uint32_t node, const CopySettings& settings);

// Removes a node, all nodes below it, and the meshes, skins, cameras, lights and animations that nothing else uses. All
// indices that glTF and this project define are renumbered. Where other extensions may contain indices, the returned
// line says so.
std::string remove_node(stage::StageFile& file, uint32_t node);

struct LightEdit {
    std::optional<std::string> kind;                       // "spot", "point", "directional"
    std::optional<glm::dvec3> color;                       // linear RGB
    std::optional<double> intensity;                       // candela; lux where directional
    std::optional<double> range_m;                         // 0: endless
    std::optional<double> inner_cone_deg, outer_cone_deg;  // half angles
};
std::string add_light(stage::StageFile& file, const std::string& name, const LightEdit& edit,
                      const Placement& placement);
// Where other nodes share the light, the node gets a light of its own first.
std::string set_light(stage::StageFile& file, uint32_t node, const LightEdit& edit);
std::string remove_light(stage::StageFile& file, uint32_t node);

// Adds a perspective camera on a node of its own at the end of the scene; an empty name stands for "camera". The angle
// is the whole vertical angle of view; the matrix is a rotation and a translation, with OpenGL axes.
std::string add_camera(stage::StageFile& file, const std::string& name, double vertical_angle_rad,
                       const glm::dmat4& world_from_camera);
// Where other nodes share the camera, the node gets a camera of its own first.
std::string set_camera(stage::StageFile& file, uint32_t node, double vertical_angle_rad);

// Sets the stage's camera path, whose times are stage times; nullopt removes it. Throws InputError for keys whose lens
// has more than a vertical angle. Clip times of keys are not kept, because each performer has its own.
std::string set_camera_path(stage::StageFile& file, const std::optional<stage::CameraPath>& path);
// Adds a key, and the path where there is none. A key within half of frame_s of the new one is replaced. The end of a
// path that ended with its last key moves with that key. Where the last key of a cyclic path comes to lie at its end or
// later, the path gets the mean time between keys to return to its first key.
std::string add_path_key(stage::StageFile& file, const stage::CameraPathKey& key, double frame_s);
// Keys count from 0. Removing the last key removes the path.
std::string remove_path_key(stage::StageFile& file, size_t key);
// The key may move past others. A key within half of frame_s of its new time is replaced.
std::string move_path_key(stage::StageFile& file, size_t key, double to_s, double frame_s);

struct PaintEdit {
    std::optional<std::string> name;
    std::optional<bool> visible;
    std::optional<double> opacity;
    std::optional<stage::PaintBlend> blend;
};
// The layers of a performer's node count from 0, the lowest.
std::string add_paint_layer(stage::StageFile& file, uint32_t node, const std::filesystem::path& paint,
                            const PaintEdit& edit);
std::string set_paint_layer(stage::StageFile& file, uint32_t node, size_t layer, const PaintEdit& edit);
std::string move_paint_layer(stage::StageFile& file, uint32_t node, size_t from, size_t to);
std::string remove_paint_layer(stage::StageFile& file, uint32_t node, size_t layer);

}  // namespace neuvv::edit
