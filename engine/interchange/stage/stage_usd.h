// The layout of a stage in OpenUSD: where performers, cameras and lights are, and when.
#pragma once

#include <filesystem>

#include "stage/stage.h"

namespace neuvv::interchange {

struct StageLayout {
    double fps = 25;                 // time samples a second, from 0 s to the stage's duration
    std::filesystem::path splats{};  // a folder; a performer whose NAME.usda lies there refers to it. Empty: none
};

// Writes a .usda in the stage's world, metres with +Y up:
// - an Xform for each performer, with its transform, its visibility, and the clip's file and frame as custom
// attributes;
// - the stage's own file as a reference, for its meshes, which programs follow that read glTF;
// - cameras as UsdGeomCamera, lights as UsdLux: spots and points as SphereLight, whose candela are a quarter of
//   `inputs:intensity` as that is spread over a sphere's surface, directional ones as DistantLight in lux.
// Written atomically; throws InputError for more than 65536 samples, and RuntimeFailure.
void write_stage_usda(const std::filesystem::path& file, const stage::Stage& stage, const StageLayout& layout);

}  // namespace neuvv::interchange
