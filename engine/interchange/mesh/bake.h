// The colours of a clip at the surface of a mesh.
#pragma once

#include <array>
#include <functional>

#include "interchange/mesh/atlas.h"
#include "interchange/volume/leaf_grid.h"
#include "media/image.h"

namespace neuvv::interchange {

// The colours of vertices, sRGB-encoded: what a ray sees that meets the surface along its normal, from two cells before
// it. Colours that depend on direction are averaged over directions around the normal, by their cosine with it.
// Vertices where there is nothing to see have the mean of the others.
std::vector<std::array<uint8_t, 3>> vertex_colours(const LeafGrid& grid, const TriangleMesh& mesh);

// A texture with the same colours at the texels of a mesh, opaque. Texels that no triangle needs continue the colours
// around them, so that smaller copies of the texture show no seams. Calls `between` some times, which may throw.
media::Image baked_texture(
    const LeafGrid& grid, const MappedMesh& mesh, uint32_t side_px, const std::function<void()>& between = [] {});

}  // namespace neuvv::interchange
