// The wearer's body, frame by frame, from the best source that the runtime and its headset have.
#pragma once

#include <optional>

#include "motion/skeleton/skeleton.h"
#include "xr/body_points.h"
#include "xr/body_tracking_types.h"
#include "xr/session.h"

namespace neuvv::xr {

// From the best one to the last resort.
enum class BodySource {
    kMetaFullBody,   // XR_FB_body_tracking with XR_META_body_tracking_full_body: 84 joints, with legs
    kMetaUpperBody,  // XR_FB_body_tracking: 70 joints of the upper body
    kBd,             // XR_BD_body_tracking: 24 joints
    kWornTrackers,   // head, hands and worn trackers (XR_HTCX_vive_tracker_interaction)
    kThreePoints,    // head and hands
};
// The best source that runtime and headset offer.
BodySource best_body_source(const Runtime& runtime);
const char* title_of(BodySource source);  // for people: "head and hands"

class BodyTracker {
  public:
    // Takes the best source that the runtime does not refuse. The session must outlive this object. Throws XrFailure
    // where session or instance are lost.
    explicit BodyTracker(const Session& session);
    ~BodyTracker();
    BodyTracker(const BodyTracker&) = delete;
    BodyTracker& operator=(const BodyTracker&) = delete;

    BodySource source() const { return source_; }
    // The wearer's pose at `time`, in the tracking space: metres, +Y up. Empty while the body is not tracked. `points`
    // (tracking space, at the same time) are used where the source is kWornTrackers or kThreePoints; of other sources'
    // poses, the nose is placed by their head. Throws XrFailure where session or instance are lost.
    std::optional<motion::Pose> locate(const BodyPoints& points, XrTime time) const;

  private:
    bool create(BodySource source);
    bool create_meta(XrBodyJointSetFB joints);
    bool create_bd();
    motion::Pose locate_meta(XrTime time) const;
    motion::Pose locate_bd(XrTime time) const;

    const Session& session_;
    BodySource source_ = BodySource::kThreePoints;
    XrBodyTrackerFB meta_ = XR_NULL_HANDLE;
    XrBodyTrackerBD bd_ = XR_NULL_HANDLE;
    // Fetched early: a lost instance returns no functions.
    PFN_xrDestroyBodyTrackerFB destroy_meta_ = nullptr;
    PFN_xrDestroyBodyTrackerBD destroy_bd_ = nullptr;
};

}  // namespace neuvv::xr
