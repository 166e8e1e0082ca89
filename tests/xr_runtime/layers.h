// What xrEndFrame was given, checked.
#pragma once

#include <array>

#include "state.h"

namespace neuvv::xr_runtime {

struct SubImage {
    Swapchain* swapchain = nullptr;
    XrRect2Di rect = {};
    uint32_t array_layer = 0;
};

struct ProjectionView {
    SubImage colour;
    std::optional<SubImage> depth;
};

struct Layer {
    bool is_quad = false;
    XrCompositionLayerFlags flags = 0;
    const Space* space = nullptr;
    std::array<ProjectionView, 2> views;  // of projection layers
    SubImage image;                       // of quads, as are the rest
    XrPosef pose = {{0, 0, 0, 1}, {0, 0, 0}};
    XrExtent2Df size = {0, 0};
    XrEyeVisibility eyes = XR_EYE_VISIBILITY_BOTH;

    bool has_depth() const { return !is_quad && views[0].depth && views[1].depth; }
};

// Refuses where the specification has an error for it, and only reports the rest.
std::vector<Layer> checked_layers(const XrFrameEndInfo& info, const Frame& frame);

}  // namespace neuvv::xr_runtime
