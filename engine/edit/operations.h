// What can be done to a stage: the same for mouse, controller and script.
//
// Each operation changes the JSON of a StageFile, nothing else, and says in a short line what changed. It expects a
// sound document (expect_sound_document) and throws InputError, having changed nothing, where it cannot be done. What
// numbers it is given is checked by whoever saves, with expect_sound_document again. Members that it does not know
// stay.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "edit/read.h"

namespace neuvv::edit {

constexpr uint32_t kMaxCopies = 511;

// A floor, a camera "camera", a spotlight "key" and a little ambient light; not on the disk yet.
stage::StageFile new_stage(const std::filesystem::path& path);

// In the space of the node's parent, metres and degrees; in this order.
struct Placement {
    std::optional<glm::dmat4> matrix;  // instead of what there was
    // The same for a hand that drags: a node that has its place in parts keeps them, as long as it is not sheared.
    std::optional<glm::dmat4> to;
    std::optional<glm::dvec3> at, move;
    std::optional<glm::dvec3> turn_deg;  // about the parent's X, then Y, then Z, where the node stands
    std::optional<glm::dvec3> scale;     // by these factors along its own axes
    std::optional<glm::dvec3> aim;       // a point that its −Z shall look at
};
std::string place_node(stage::StageFile& file, uint32_t node, const Placement& placement);
// With a number behind it where another node bears the name.
std::string rename_node(stage::StageFile& file, uint32_t node, const std::string& name);

struct PerformerEdit {
    std::optional<std::filesystem::path> clip;  // a .nvv
    std::optional<stage::TimeMap> time;
    std::optional<double> spin_deg_per_s, opacity;
    std::optional<bool> visible, casts_shadow, receives_shadow;
};
// A node of its own at the end of the scene. Without a name: the file's.
std::string add_performer(stage::StageFile& file, const std::string& name, const PerformerEdit& edit,
                          const Placement& placement);
std::string set_performer(stage::StageFile& file, uint32_t node, const PerformerEdit& edit);

// Shown or hidden together with all that hangs on it, by KHR_node_visibility: meshes, lights and performers; cameras
// stay. A performer that is shown is also seen by its own `visible`.
std::string show_node(stage::StageFile& file, uint32_t node, bool visible);
// For programs in which one could move a node by mistake (extras.neuvv.locked); operations do not mind it.
std::string lock_node(stage::StageFile& file, uint32_t node, bool locked);

struct StageEdit {
    std::optional<double> duration_s, fps;
    std::optional<glm::dvec3> background, ambient;
    std::optional<std::filesystem::path> environment;  // empty: none any more
    std::optional<double> environment_intensity, environment_rotation_deg;
    std::optional<stage::StageBlend> blend;
    std::optional<bool> shadows, falloff;
};
std::string set_stage(stage::StageFile& file, const StageEdit& edit);

// Copies of a node and what hangs on it. The node itself stays where it is: the first of a row along +X, of a circle on
// which everyone looks outward (the middle lies behind the node, whose front is +Z), or of an arc of such a circle,
// whose last copy stands arc_deg further on, counter-clockwise seen from above. Copies share meshes, lights, clips.
enum class CopyPattern { kRow, kRing, kFan };
struct CopySettings {
    uint32_t count = 1;  // of copies, 1..kMaxCopies
    CopyPattern pattern = CopyPattern::kRow;
    double distance_m = 1;    // between neighbours of a row; radius of ring and fan
    double arc_deg = 90;      // of a fan
    stage::ClipTime stagger;  // each copy is so much behind the one before; what never ends runs from the start on
    double spin_step = 0;     // each spins so much faster, degrees per second
};
std::string duplicate_node(stage::StageFile& file, uint32_t node, const CopySettings& settings);

// The node, what hangs on it, and the meshes, skins, cameras, lights and animations that nothing else uses. All indices
// that glTF and this project know are renumbered; where other extensions may hold some, the line says so.
std::string remove_node(stage::StageFile& file, uint32_t node);

struct LightEdit {
    std::optional<std::string> kind;                       // "spot", "point", "directional"
    std::optional<glm::dvec3> color;                       // linear RGB
    std::optional<double> intensity;                       // candela, lux
    std::optional<double> range_m;                         // 0: endless
    std::optional<double> inner_cone_deg, outer_cone_deg;  // half angles
};
std::string add_light(stage::StageFile& file, const std::string& name, const LightEdit& edit,
                      const Placement& placement);
// A light that other nodes share becomes the node's own first.
std::string set_light(stage::StageFile& file, uint32_t node, const LightEdit& edit);
std::string remove_light(stage::StageFile& file, uint32_t node);

// A perspective camera on a node of its own at the end of the scene; without a name: "camera". The angle is the whole
// vertical one of view; the matrix a rotation and a place, OpenGL axes.
std::string add_camera(stage::StageFile& file, const std::string& name, double vertical_angle_rad,
                       const glm::dmat4& world_from_camera);
// A camera that other nodes share becomes the node's own first.
std::string set_camera(stage::StageFile& file, uint32_t node, double vertical_angle_rad);

// The stage's camera path, whose time is the stage's; none: it has none any more. Throws for keys whose lens has more
// than a vertical angle; times of the clip are not kept, for each performer has its own.
std::string set_camera_path(stage::StageFile& file, const std::optional<stage::CameraPath>& path);
// Makes the path if need be. The key that stands within half of frame_s is replaced. A path's end goes along with its
// last key; a cycle whose last key comes to stand at its end gets the time that it takes from key to key.
std::string add_path_key(stage::StageFile& file, const stage::CameraPathKey& key, double frame_s);
// Keys count from 0. Without its last key the path is gone.
std::string remove_path_key(stage::StageFile& file, size_t key);
// It may pass others; one that stands within half of frame_s of where it goes is replaced.
std::string move_path_key(stage::StageFile& file, size_t key, double to_s, double frame_s);

struct PaintEdit {
    std::optional<std::string> name;
    std::optional<bool> visible;
    std::optional<double> opacity;
    std::optional<stage::PaintBlend> blend;
};
// Layers of a performer's node count from 0, the lowest.
std::string add_paint_layer(stage::StageFile& file, uint32_t node, const std::filesystem::path& paint,
                            const PaintEdit& edit);
std::string set_paint_layer(stage::StageFile& file, uint32_t node, size_t layer, const PaintEdit& edit);
std::string move_paint_layer(stage::StageFile& file, uint32_t node, size_t from, size_t to);
std::string remove_paint_layer(stage::StageFile& file, uint32_t node, size_t layer);

}  // namespace neuvv::edit
