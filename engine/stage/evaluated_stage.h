// A stage evaluated at one time: its performers, lights and cameras in world space, as a renderer needs them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stage/camera_path.h"
#include "stage/pose.h"
#include "stage/stage.h"

namespace neuvv::stage {

struct EvaluatedPerformer {
    uint32_t performer = 0;              // index into Stage::performers
    uint32_t clip = 0;                   // index into Stage::clips
    float frame = 0;                     // 0..frames − 1 of the clip
    glm::dmat4 world_from_performer{1};  // the node's transform with the spin; invertible where visible
    float opacity = 1;
    bool visible = true;  // the performer and its node are visible, and no animation makes the transform flat
    bool casts_shadow = true, receives_shadow = true;
};

struct EvaluatedLight {
    uint32_t node = 0;  // index into GltfScene::nodes
    GltfLightKind kind = GltfLightKind::kPoint;
    glm::dvec3 position{0};               // world, metres
    glm::dvec3 direction{0, 0, -1};       // world, unit: the direction in which the light shines
    glm::dvec3 intensity{1};              // linear RGB: colour × candela, or lux where directional
    double range_m = 0;                   // 0: unlimited
    double cos_inner = 1, cos_outer = 0;  // cosines of a spot's half angles
};

struct EvaluatedCamera {
    uint32_t node = 0;                // index into GltfScene::nodes
    std::string name;                 // the node's name, else the camera's, else "camera 0"
    glm::dmat4 world_from_camera{1};  // a rotation and a position, OpenGL axes
    double vertical_angle_rad = 0;    // the whole vertical angle of view
    bool orthographic = false;        // camera_of refuses orthographic cameras
};

struct EvaluatedStage {
    double time_s = 0;
    PosedScene pose;
    std::vector<EvaluatedPerformer> performers;  // one for each of Stage::performers, in the same order
    std::vector<EvaluatedLight> lights;          // in the order of their nodes
    std::vector<EvaluatedCamera> cameras;        // in the order of their nodes
};

// Evaluates the stage at any finite time in seconds. All animations of the file play at once from 0 s. Lights and
// cameras are those of the default scene. Hidden lights are left out, and so are lights and cameras while an animation
// moves them to a position that is not finite or farther than 1e9 m from the origin.
EvaluatedStage stage_at(const Stage& stage, double stage_s);

// The axis-aligned box (min, max) around all performers' boxes, world metres; ±1 m where there are no performers.
std::pair<glm::dvec3, glm::dvec3> performers_box(const Stage& stage, const EvaluatedStage& evaluated);

// Whether the stage has a perspective camera, which camera_of accepts.
bool has_camera(const EvaluatedStage& evaluated);

// The camera of this name; else the camera whose index in evaluated.cameras is given in decimal; for an empty string
// the first perspective camera. Pixels are square, and the vertical angle of view is the file's. Throws InputError that
// lists the stage's cameras where none or several match, or where the camera is orthographic.
Camera camera_of(const Stage& stage, const std::string& name_or_index, const EvaluatedStage& evaluated, uint32_t width,
                 uint32_t height);

// A camera of the stage, chosen as by camera_of, as a path: where animations move it, a key `fps` times a second from 0
// s to the end of the last of them, linear in between; else one key. Throws InputError as camera_of does, and for more
// than kMaxPathKeys keys.
CameraPath path_of_camera(const Stage& stage, const std::string& name_or_index, double fps);
CameraPath path_of_camera(const Stage& stage, size_t index, double fps);  // of evaluated.cameras, whatever its name

}  // namespace neuvv::stage
