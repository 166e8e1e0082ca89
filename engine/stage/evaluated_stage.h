// A stage at a time: where everything is, in world space. What a renderer draws.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "stage/camera.h"
#include "stage/pose.h"
#include "stage/stage.h"

namespace neuvv::stage {

struct EvaluatedPerformer {
    uint32_t performer = 0;              // index into Stage::performers
    uint32_t clip = 0;                   // index into Stage::clips
    float frame = 0;                     // 0..frames − 1 of the clip
    glm::dmat4 world_from_performer{1};  // its node's, spin included; invertible where visible
    float opacity = 1;
    bool visible = true;  // its own, and its node's; false too while an animation makes the transform flat
    bool casts_shadow = true, receives_shadow = true;
};

struct EvaluatedLight {
    uint32_t node = 0;
    GltfLightKind kind = GltfLightKind::kPoint;
    glm::dvec3 position{0};
    glm::dvec3 direction{0, 0, -1};       // unit, in which it shines
    glm::dvec3 intensity{1};              // linear RGB: colour × candela, or lux where directional
    double range_m = 0;                   // 0: without end
    double cos_inner = 1, cos_outer = 0;  // of a spot's half angles
};

struct EvaluatedCamera {
    uint32_t node = 0;
    std::string name;                 // the node's, else the camera's, else "camera 0"
    glm::dmat4 world_from_camera{1};  // a rotation and a place, OpenGL axes
    double vertical_angle_rad = 0;    // of view
    bool orthographic = false;        // then camera_of refuses it
};

struct EvaluatedStage {
    double time_s = 0;
    PosedScene pose;
    std::vector<EvaluatedPerformer> performers;  // as Stage::performers
    std::vector<EvaluatedLight> lights;          // by node
    std::vector<EvaluatedCamera> cameras;        // by node
};

// At any finite time; all animations of the file play at once from 0. Only what the default scene holds; lights and
// cameras that an animation sends out of this world are left out meanwhile, and so are hidden lights.
EvaluatedStage stage_at(const Stage& stage, double stage_s);

// World box, low and high, around the boxes of all performers; ±1 m where there are none.
std::pair<glm::dvec3, glm::dvec3> performers_box(const Stage& stage, const EvaluatedStage& evaluated);

// Whether there is one that camera_of takes.
bool has_camera(const EvaluatedStage& evaluated);

// The camera of this name, else of this index into time.cameras in decimal; empty: the first that is not
// orthographic. Square pixels, the file's vertical angle. Throws InputError listing what there is.
Camera camera_of(const Stage& stage, const std::string& name_or_index, const EvaluatedStage& evaluated, uint32_t width,
                 uint32_t height);

}  // namespace neuvv::stage
