// Internal to this module: tangents for primitives whose material has a normal map.
#pragma once

#include "stage/gltf/gltf_scene.h"

namespace neuvv::stage {

// A unit tangent at a right angle to the unit normal, as near to `along` as possible; any such tangent where `along` is
// parallel to the normal or 0. w is −1 where `mirrored`, else 1.
glm::vec4 tangent_across(const glm::vec3& normal, const glm::vec3& along, bool mirrored);

// Adds tangents to a primitive whose file has none, from its positions, normals and the normal map's UVs. A vertex's
// tangent is the direction in which U grows on the triangles at the vertex, weighted by each triangle's angle there and
// made orthogonal to the vertex's normal. The bitangent goes against V, because textures count V downwards and normal
// maps have +Y up. That is MikkTSpace's rule with one exception: no vertex is split, so where mirrored halves of a
// texture share vertices, the side with the larger angle wins. A primitive without UVs for its normal map gets no
// tangents; the normal map then has no effect.
void add_tangents(GltfPrimitive& primitive);

}  // namespace neuvv::stage
