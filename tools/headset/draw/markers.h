// Markers: the shapes that show where the lights and cameras of a stage are, while the tool kLights is selected.
#pragma once

#include <optional>
#include <vector>

#include "tools/headset/state/hand.h"
#include "tools/headset/state/headset_state.h"
#include "xr/draw/eye_shapes.h"

namespace neuvv::headset {

struct Marker {
    uint32_t node = 0;  // of the light or camera
    size_t index = 0;   // of EvaluatedStage::cameras, or of its lights
    bool is_camera = false;
    xr::Pose world_from_marker;  // it looks along −Z
    double radius_m = 0;         // larger where it is far from the user, so that a ray meets it from there, too
};
// The lights and cameras of the evaluated stage, where they are now. Hidden lights are no part of it, and what the
// user's head is in has no marker: users begin where the stage's first camera is.
std::vector<Marker> markers_of(const HeadsetState& state);

struct MarkerHit {
    uint32_t node = 0;
    double distance_m = 0;
};
// The nearest marker that a ray (world) passes through; nullopt where there is none, or another tool is selected.
std::optional<MarkerHit> marker_on(const Ray& ray, const HeadsetState& state);

// The selected node where it is a light or camera.
std::optional<uint32_t> selected_marker(const HeadsetState& state);

void draw_markers(xr::EyeShapes& shapes, const HeadsetState& state, const Hands& hands);

}  // namespace neuvv::headset
