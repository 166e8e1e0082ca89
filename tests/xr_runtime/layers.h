// The layers that xrEndFrame receives, after checks.
#pragma once

#include <algorithm>
#include <vector>

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

enum class LayerKind { kProjection, kQuad, kPassthrough };

struct Layer {
    LayerKind kind = LayerKind::kProjection;
    XrCompositionLayerFlags flags = 0;
    const Space* space = nullptr;
    std::vector<ProjectionView> views;  // of a projection layer: left, right, and the narrow ones in this order
    std::vector<XrFovf> fov;            // of these views
    SubImage image;                     // of a quad, as are the members below
    XrPosef pose = {{0, 0, 0, 1}, {0, 0, 0}};
    XrExtent2Df size = {0, 0};
    XrEyeVisibility eyes = XR_EYE_VISIBILITY_BOTH;

    bool is_projection() const { return kind == LayerKind::kProjection; }
    bool is_quad() const { return kind == LayerKind::kQuad; }
    bool has_depth() const {
        return is_projection() && std::all_of(views.begin(), views.end(),
                                              [](const ProjectionView& view) { return view.depth.has_value(); });
    }
};

// Refuses violations for which the specification defines an error, and only reports the others.
std::vector<Layer> checked_layers(const XrFrameEndInfo& info, const Session& session, const Frame& frame);

}  // namespace neuvv::xr_runtime
