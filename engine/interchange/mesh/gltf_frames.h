// Frames of a clip in glTF.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "stage/gltf/glb_writer.h"

namespace neuvv::interchange {

// A scene with a node for each frame, whose mesh is `meshes`[i], or nothing where that is null: glTF has no mesh
// without vertices. Where there are several, an animation shows one after the other by their scales, `fps` of them a
// second. Below a node at `origin` where that is not 0: JSON has more digits than the floats of meshes.
void add_gltf_frames(stage::GlbWriter& glb, const std::vector<nlohmann::ordered_json>& meshes, double fps,
                     const glm::dvec3& origin = glm::dvec3(0));

}  // namespace neuvv::interchange
