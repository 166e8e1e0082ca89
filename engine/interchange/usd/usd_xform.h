// Transforms of OpenUSD's prims: the ops of UsdGeomXformable at a time.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "interchange/usd/usd_text.h"

namespace neuvv::interchange {

// The value at a time code: between two samples linear, and held before the first and after the last; the value itself
// where there are no samples. Values whose numbers differ in count are held, too.
UsdValue usd_value_at(const UsdAttribute& attribute, double time_code);

// The prim's own transform, to the space of its parent, in the file's units and axes. Throws InputError for an op that
// OpenUSD does not know, or one without numbers; `file` is for the error.
glm::dmat4 usd_local_transform(const UsdPrim& prim, double time_code, const std::string& file);
// Whether a prim's transform leaves out those of its parents.
bool usd_resets_stack(const UsdPrim& prim);

// The world of a file in metres with +Y up, from the file's units and axes.
glm::dmat4 usd_world_from_layer(const UsdLayer& layer, const std::string& file);

}  // namespace neuvv::interchange
