// A stage's pictures in a headset: rendered for both eyes, brought to the session's images with hands and holes over
// them, as a layer of the frame.
#pragma once

#include <memory>
#include <optional>

#include "tools/viewer/dynamic_scale.h"
#include "xr/eye_camera.h"
#include "xr/eye_pass.h"

namespace neuvv {

struct EyeQuality {
    double scale = 0;                // rays a pixel along each side; 0: as many as the refresh rate allows
    std::optional<double> inset;     // so much of a picture's side has all rays, what is beside it half
    bool mask = true, depth = true;  // where the runtime knows them
    bool keep_pictures = false;      // for left()
};

class EyeImages {
  public:
    // Of the size that the runtime recommends. All must outlive it.
    EyeImages(const Device& device, const Session& session, const EyeQuality& quality);

    VkExtent2D size() const { return colour_->size(); }
    // What a renderer must have room for.
    FrameCapacity capacity() const;
    const char* format_name() const;

    // A lens hides another part now.
    void look_at_mask(uint32_t eye) { old_mask_[eye] = true; }

    // Draws the instant that the renderer was made to show, from eyes that stand on the rig, with what shall be shown
    // next sliced ahead. Waits for the device. `budget_ms`: in which a picture should be drawn.
    void draw(StageRenderer& renderer, const StageInstant& instant, const EyeViews& eyes,
              const Pose& world_from_tracking, std::span<const NextSlice> next, const EyeShapes& shapes,
              double vignette, double budget_ms);
    // What was drawn last, for the frame's end. `over_holes`: layers beneath show through holes.
    const XrCompositionLayerBaseHeader* layer(const Session& session, bool over_holes);

    // How large the middle pixels of the last picture look.
    double pixel_rad() const { return 1 / cameras_[0].fx; }
    double scale() const { return drawn_scale_; }
    // The left eye's picture (layout TRANSFER_SRC), where pictures are kept.
    const DeviceImage* left() const { return kept_left_ ? &*left_ : nullptr; }

  private:
    void hide(StageRenderer& renderer, const EyeViews& eyes);
    FrameSettings settings_of(const StageRenderer& renderer, const StageInstant& instant,
                              std::span<const NextSlice> next) const;
    void keep_left(VkImage image);
    const Device& device_;
    const Session& session_;
    EyeQuality quality_;
    std::unique_ptr<XrImages> colour_, depth_;
    DeviceImage own_depth_;
    EyePass pass_;
    std::array<Camera, kEyes> cameras_{Camera{.fx = 1000}, Camera{.fx = 1000}};
    std::array<bool, kEyes> old_mask_{true, true};
    std::array<XrFovf, kEyes> mask_fov_{};
    std::array<std::vector<glm::vec2>, kEyes> hidden_;
    DynamicScale dynamic_;
    double drawn_scale_ = 1;
    EyeViews drawn_;
    std::optional<DeviceImage> left_;
    bool kept_left_ = false;  // it holds a picture
    Commands commands_;
    XrCompositionLayerProjection projection_{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
    std::array<XrCompositionLayerProjectionView, kEyes> views_{};
    std::array<XrCompositionLayerDepthInfoKHR, kEyes> depths_{};
};

}  // namespace neuvv
