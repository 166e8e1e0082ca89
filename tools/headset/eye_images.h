// A stage's images in a headset: rendered for both eyes, brought to the session's images with hands and holes over
// them, as a layer of the frame.
#pragma once

#include <memory>
#include <optional>

#include "editor/dynamic_scale.h"
#include "xr/eye_camera.h"
#include "xr/eye_pass.h"

namespace neuvv::headset {

struct EyeQuality {
    double scale = 0;                // rays a pixel along each side; 0: as many as the refresh rate allows
    std::optional<double> inset;     // so much of an image's side has all rays, what is beside it half
    bool mask = true, depth = true;  // where the runtime knows them
    bool keep_images = false;        // for left()
};

class EyeImages {
  public:
    // Of the size that the runtime recommends. All must outlive it.
    EyeImages(const gpu::Device& device, const xr::Session& session, const EyeQuality& quality);

    VkExtent2D size() const { return colour_->size(); }
    // What a renderer must have room for.
    render::FrameCapacity capacity() const;
    const char* format_name() const;

    // A lens hides another part now.
    void look_at_mask(uint32_t eye) { old_mask_[eye] = true; }

    // Draws the time that the renderer was made to show, from eyes that stand on the rig, with what shall be shown
    // next sliced ahead. Waits for the device. `budget_ms`: in which an image should be drawn.
    void draw(render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated, const xr::EyeViews& eyes,
              const xr::Pose& world_from_tracking, std::span<const render::NextSlice> next, const xr::EyeShapes& shapes,
              double vignette, double budget_ms);
    // What was drawn last, for the frame's end. `over_holes`: layers beneath show through holes.
    const XrCompositionLayerBaseHeader* layer(const xr::Session& session, bool over_holes);

    // How large the middle pixels of the last image look.
    double pixel_rad() const { return 1 / cameras_[0].fx; }
    double scale() const { return drawn_scale_; }
    // The left eye's image (layout TRANSFER_SRC), where images are kept.
    const gpu::DeviceImage* left() const { return kept_left_ ? &*left_ : nullptr; }

  private:
    void hide(render::StageRenderer& renderer, const xr::EyeViews& eyes);
    render::FrameSettings settings_of(const render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated,
                                      std::span<const render::NextSlice> next) const;
    void keep_left(VkImage image);
    const gpu::Device& device_;
    const xr::Session& session_;
    EyeQuality quality_;
    std::unique_ptr<xr::SwapchainImages> colour_, depth_;
    gpu::DeviceImage own_depth_;
    xr::EyePass pass_;
    std::array<stage::Camera, xr::kEyes> cameras_{stage::Camera{.fx = 1000}, stage::Camera{.fx = 1000}};
    std::array<bool, xr::kEyes> old_mask_{true, true};
    std::array<XrFovf, xr::kEyes> mask_fov_{};
    std::array<std::vector<glm::vec2>, xr::kEyes> hidden_;
    editor::DynamicScale dynamic_;
    double drawn_scale_ = 1;
    xr::EyeViews drawn_;
    std::optional<gpu::DeviceImage> left_;
    bool kept_left_ = false;  // it holds an image
    gpu::Commands commands_;
    XrCompositionLayerProjection projection_{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
    std::array<XrCompositionLayerProjectionView, xr::kEyes> views_{};
    std::array<XrCompositionLayerDepthInfoKHR, xr::kEyes> depths_{};
};

}  // namespace neuvv::headset
