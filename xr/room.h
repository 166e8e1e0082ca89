// The user's own room behind what is drawn: how a headset can show it, and what a frame needs for that.
#pragma once

#include "xr/session.h"

namespace neuvv::xr {

// The ways to see the room, the best one last.
enum class RoomView {
    kNone,
    kAdditive,     // the display is transparent and adds light: what is black shows the room, and shadows do not
    kPassthrough,  // a layer of camera images beneath all others (XR_FB_passthrough)
    kAlphaBlend,   // the blend mode of that name: the room is where the alpha of all layers is below 1
};
RoomView best_room_view(const Runtime& runtime);
// Such as "XR_FB_passthrough"; for kNone "not possible".
const char* title_of(RoomView view);

class Room {
  public:
    // The session must outlive this object.
    explicit Room(const Session& session);
    ~Room() { hide(); }
    Room(const Room&) = delete;
    Room& operator=(const Room&) = delete;

    // Shows or hides the room from the next frame on. A headset that cannot show the room does not, and one that cannot
    // hide the room, as its runtime has no opaque blend mode, always shows it. Throws XrFailure only where session or
    // instance are lost.
    void show(bool wanted);
    // To be called when SessionEvents::passthrough_lost says so; the next show() begins anew.
    void restart() { hide(); }
    bool is_shown() const { return is_shown_; }
    // How it is seen while it is shown; kNone, too, where the runtime has refused the passthrough that it offers.
    RoomView view() const { return view_; }

    // For the end of a frame: the blend mode, and the layer beneath all others, null where none is needed. Where the
    // room is shown, the eyes' layer must be blended by its alpha; the panel, which is opaque, hides the room.
    XrEnvironmentBlendMode blend_mode() const;
    const XrCompositionLayerBaseHeader* layer() const;

  private:
    bool start_passthrough();
    void hide();
    const Session& session_;
    RoomView view_;
    bool is_shown_ = false;
    PFN_xrDestroyPassthroughFB destroy_passthrough_ = nullptr;
    PFN_xrDestroyPassthroughLayerFB destroy_images_ = nullptr;
    XrPassthroughFB passthrough_ = XR_NULL_HANDLE;
    XrPassthroughLayerFB images_ = XR_NULL_HANDLE;
    XrCompositionLayerPassthroughFB layer_{XR_TYPE_COMPOSITION_LAYER_PASSTHROUGH_FB};
};

}  // namespace neuvv::xr
