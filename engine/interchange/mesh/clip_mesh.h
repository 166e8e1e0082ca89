// A frame of a clip as a closed mesh with its colours: all steps in their order.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "interchange/mesh/mesh_image.h"
#include "slice/slice.h"

namespace neuvv::interchange {

struct MeshSettings {
    double opacity = 0.5;           // which a ray gets where the surface is; above 0, below 1
    size_t most_triangles = 50000;  // 0: no limit
    double smallest_part = 0.02;    // parts whose box is smaller are dropped; relative to the largest one's diagonal
    uint32_t texture_px = 1024;     // of each side; 0: colours of vertices
};

// Nothing where the texture is too small for the mesh; a mesh without triangles where the frame shows nothing. Calls
// `working` some times with what is being done; it may throw.
std::optional<ColouredMesh> clip_mesh(slice::Slice volume, const MeshSettings& settings,
                                      const std::function<void(std::string_view what)>& working);

}  // namespace neuvv::interchange
