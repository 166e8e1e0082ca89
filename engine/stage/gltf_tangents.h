// For this module alone: tangents where a material has a normal map.
#pragma once

#include "stage/gltf_scene.h"

namespace neuvv::stage {

// A unit tangent at a right angle to the normal, as near to `along` as may be, and any where that says nothing.
glm::vec4 tangent_across(const glm::vec3& normal, const glm::vec3& along, bool mirrored);

// For primitives without tangents of their own, from positions, normals and the normal map's UVs: the direction in
// which U grows on each triangle, weighted at each of its vertices by the triangle's angle there, made orthogonal to
// the vertex's normal. The bitangent goes against V (textures count V downwards, normal maps have +Y up). That is
// MikkTSpace's rule but for one thing: no vertex is split, so where mirrored halves of a texture share vertices, the
// larger angle's side wins. Primitives whose file has no such UVs get no tangents: their normal map does nothing.
void add_tangents(GltfPrimitive& primitive);

}  // namespace neuvv::stage
