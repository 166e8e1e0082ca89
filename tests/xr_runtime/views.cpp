// The views, two or four, and the mask of those parts of them that are never visible.
#include <array>
#include <cmath>

#include "call.h"
#include "pose.h"
#include "spaces.h"

namespace neuvv::xr_runtime {

namespace {

// The frame with this predicted display time that has been waited for and is not ended; null where there is none.
Frame* open_frame(Session& session, XrTime time) {
    if (session.begun && session.begun->display_time == time) return &*session.begun;
    if (session.waited && session.waited->display_time == time) return &*session.waited;
    return nullptr;
}

void check_locate_time(Session& session, XrTime time, bool follows_gaze) {
    check_time(time);
    Frame* frame = open_frame(session, time);
    if (frame) {
        frame->follows_gaze = follows_gaze;
        if (frame->locate_count++ > 0) warn("locate-views", "xrLocateViews more than once in a frame");
    } else if (session.begun || session.waited) {
        violate("display-time",
                "xrLocateViews with another time than the frame's predictedDisplayTime: its poses "
                "would belong to another moment than the image");
    }
}

XrResult locate_views(XrSession handle, const XrViewLocateInfo* locate_info, XrViewState* out_state, uint32_t capacity,
                      uint32_t* count, XrView* out) {
    Session& session = object<Session>(handle);
    const XrViewLocateInfo& info = checked(locate_info);
    XrViewState& state = checked(out_state);
    const Space& space = object<Space>(info.space);
    check_view_configuration(info.viewConfigurationType);
    if (session.is_running && info.viewConfigurationType != session.views)
        violate("view-configuration", "xrLocateViews with another view configuration than the session began with");
    const auto* foveated = chained<XrViewLocateFoveatedRenderingVARJO>(locate_info);
    const bool follows_gaze = foveated && foveated->foveatedRenderingActive && gaze_in_world(info.displayTime).is_valid;
    if (capacity == 0)
        check_time(info.displayTime);
    else
        check_locate_time(session, info.displayTime, follows_gaze);

    state.viewStateFlags = 0;
    if (view_in(space, 0, info.displayTime).is_valid)
        state.viewStateFlags = XR_VIEW_STATE_ORIENTATION_VALID_BIT | XR_VIEW_STATE_POSITION_VALID_BIT |
                               XR_VIEW_STATE_ORIENTATION_TRACKED_BIT | XR_VIEW_STATE_POSITION_TRACKED_BIT;
    const uint32_t views = view_count(info.viewConfigurationType);
    return give_structs(capacity, count, out, views, [&](XrView& view, size_t i) {
        const Located located = view_in(space, static_cast<uint32_t>(i), info.displayTime);
        view.pose = located.is_valid ? located.pose : kIdentityPose;
        view.fov = fov_of(static_cast<uint32_t>(i), info.displayTime, follows_gaze);
    });
}

// --- The visibility mask: an ellipse in the field of view is visible, the corners outside it are hidden ---

struct Mesh {
    std::vector<XrVector2f> vertices;
    std::vector<uint32_t> indices;
};

constexpr uint32_t kQuarterSteps = 8;

struct Ellipse {
    XrVector2f centre, radius;
    XrVector2f at(uint32_t step) const {
        const float angle = static_cast<float>(step) / kQuarterSteps * 1.57079633f;
        return {centre.x + radius.x * std::cos(angle), centre.y + radius.y * std::sin(angle)};
    }
};

// The ellipse on the plane z = -1. Each change of the mask by the script makes it a little smaller, or large again.
Ellipse ellipse_of(const XrFovf& fov, float scale) {
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
    return {{(left + right) / 2, (up + down) / 2}, {(right - left) / 2 * scale, (up - down) / 2 * scale}};
}

// The hidden triangles: from each corner, a fan to its quarter of the ellipse, counter-clockwise.
Mesh hidden_mesh(const XrFovf& fov, float scale) {
    const Ellipse inner = ellipse_of(fov, scale), outer = ellipse_of(fov, 1);
    Mesh mesh;
    constexpr std::array<XrVector2f, 4> kCorners = {{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
    for (uint32_t quarter = 0; quarter < 4; ++quarter) {
        const auto first = static_cast<uint32_t>(mesh.vertices.size());
        const XrVector2f corner = {outer.centre.x + kCorners[quarter].x * outer.radius.x,
                                   outer.centre.y + kCorners[quarter].y * outer.radius.y};
        mesh.vertices.push_back(corner);
        mesh.vertices.push_back(outer.at(quarter * kQuarterSteps));
        for (uint32_t i = 0; i <= kQuarterSteps; ++i) mesh.vertices.push_back(inner.at(quarter * kQuarterSteps + i));
        mesh.vertices.push_back(outer.at((quarter + 1) * kQuarterSteps));
        for (uint32_t i = 1; i < kQuarterSteps + 3; ++i) {
            const uint32_t triangle[] = {first, first + i + 1, first + i};
            mesh.indices.insert(mesh.indices.end(), triangle, triangle + 3);
        }
    }
    return mesh;
}

Mesh visible_mesh(const Ellipse& ellipse) {
    Mesh mesh;
    mesh.vertices.push_back(ellipse.centre);
    for (uint32_t i = 0; i < 4 * kQuarterSteps; ++i) {
        mesh.vertices.push_back(ellipse.at(i));
        const uint32_t triangle[] = {0, i + 1, (i + 1) % (4 * kQuarterSteps) + 1};
        mesh.indices.insert(mesh.indices.end(), triangle, triangle + 3);
    }
    return mesh;
}

Mesh outline(const Ellipse& ellipse) {
    Mesh mesh;
    for (uint32_t i = 0; i < 4 * kQuarterSteps; ++i) {
        mesh.vertices.push_back(ellipse.at(i));
        mesh.indices.push_back(i);
    }
    return mesh;
}

Mesh mask_of(uint32_t view, XrVisibilityMaskTypeKHR type) {
    const Runtime& state = runtime();
    if (!state.script.has_mask) return {};
    const float scale = state.progress.mask_version % 2 ? 0.9f : 1.0f;
    const XrFovf& fov = state.script.fov[view % 2];  // the lens hides the same of both views of an eye
    switch (type) {
        case XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR:
            return hidden_mesh(fov, scale);
        case XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR:
            return visible_mesh(ellipse_of(fov, scale));
        case XR_VISIBILITY_MASK_TYPE_LINE_LOOP_KHR:
            return outline(ellipse_of(fov, scale));
        default:
            refuse(XR_ERROR_VALIDATION_FAILURE, "enum", "no XrVisibilityMaskTypeKHR");
    }
}

XrResult get_visibility_mask(XrSession handle, XrViewConfigurationType type, uint32_t view,
                             XrVisibilityMaskTypeKHR mask_type, XrVisibilityMaskKHR* out) {
    object<Session>(handle);
    check_view_configuration(type);
    require(view < view_count(type), XR_ERROR_VALIDATION_FAILURE, "view-index",
            "the viewIndex must be below the number of views");
    XrVisibilityMaskKHR& mask = checked(out);
    const Mesh mesh = mask_of(view, mask_type);
    mask.vertexCountOutput = static_cast<uint32_t>(mesh.vertices.size());
    mask.indexCountOutput = static_cast<uint32_t>(mesh.indices.size());
    if (mask.vertexCapacityInput == 0 && mask.indexCapacityInput == 0) return XR_SUCCESS;
    if (mask.vertexCapacityInput < mesh.vertices.size() || mask.indexCapacityInput < mesh.indices.size())
        decline(XR_ERROR_SIZE_INSUFFICIENT);
    check_pointer(mask.vertices, "vertices");
    check_pointer(mask.indices, "indices");
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), mask.vertices);
    std::copy(mesh.indices.begin(), mesh.indices.end(), mask.indices);
    return XR_SUCCESS;
}

}  // namespace

std::vector<EntryPoint> view_entries() {
    return {
        NEUVV_XR_ENTRY(xrLocateViews, locate_views),
        NEUVV_XR_ENTRY_OF(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME, nullptr, xrGetVisibilityMaskKHR, get_visibility_mask)};
}

}  // namespace neuvv::xr_runtime
