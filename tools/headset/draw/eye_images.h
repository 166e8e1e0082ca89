// The images of a stage in a headset: rendered for each view of both eyes, and drawn to the session's swapchains with
// shapes and holes over them, as a projection layer of the frame.
#pragma once

#include <memory>
#include <optional>

#include "editor/draw/dynamic_scale.h"
#include "tools/headset/draw/drawn_share.h"
#include "xr/draw/eye_camera.h"
#include "xr/draw/eye_pass.h"

namespace neuvv::headset {

struct EyeQuality {
    // Rays per pixel along each side; 0: as many as the refresh rate allows. Where that is fewer than one, a smaller
    // rectangle of the image is drawn (DrawnShare).
    double scale = 0;
    // The share of an image's side that gets all rays, where the eyes look; the rest gets half as many. Not used where
    // the headset has narrow views, which are for the same.
    std::optional<double> inset;
    bool far_levels = true;    // FrameSettings::far_levels
    bool mask = true;          // leave out what lenses hide, where the runtime has a visibility mask
    bool depth = true;         // give depth to the compositor, where the runtime takes it
    bool keep_images = false;  // for left()
};

// Whether an image is recorded while the device draws the one before: not on software devices, which draw on the
// processor that would do other work meanwhile, and whose times are the host's.
bool images_overlap(const gpu::Device& device);

class EyeImages {
  public:
    // The images have the size that the runtime recommends, the largest one of all views. Device and session must
    // outlive this object.
    EyeImages(const gpu::Device& device, const xr::Session& session, const EyeQuality& quality);

    ~EyeImages();
    EyeImages(const EyeImages&) = delete;
    EyeImages& operator=(const EyeImages&) = delete;

    VkExtent2D size() const { return colour_->size(); }
    // The capacity that a renderer of these images needs.
    render::FrameCapacity capacity() const;
    const char* format_name() const;

    // EyePass::set_font
    void set_font(const gpu::DeviceImage& image) { pass_.set_font(image); }
    // To be called when the lens hides another part of a view than before.
    void invalidate_mask(uint32_t view) { mask_outdated_[view] = true; }

    // Whether the user's own room is seen where the stage is not, from the next image on: there is no background then.
    void show_room(bool shown) { shows_room_ = shown; }
    // Where the inset is from the next image on: around a point (world), or in the centre where none is known.
    void look_at(const std::optional<glm::dvec3>& point_world) { looks_at_ = point_world; }
    // Draws what the renderer shows (StageRenderer::show) for all views, and prefetches the slices in `next`, all in
    // one submission, for which nobody waits where images_overlap(). `highlight` says which
    // parts of a performer are red. `eyes` are in the tracking space. `budget_ms` is the time that an image may take,
    // for EyeQuality::scale 0.
    void draw(render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated,
              const render::PerformerHighlight& highlight, const xr::EyeViews& eyes,
              const xr::Pose& world_from_tracking, std::span<const render::Instance> next, const xr::EyeShapes& shapes,
              const xr::EyeShade& shade, double budget_ms);
    // The layer with the images that were drawn last; it is valid until the next call. With `over_layers`, what is
    // beneath is seen where their alpha is below 1: panels through holes, and the room.
    const XrCompositionLayerBaseHeader* layer(const xr::Session& session, bool over_layers);

    // The angle of a pixel in the centre of the last image.
    double pixel_rad() const { return 1 / cameras_[0].fx; }
    // Rays per pixel of the whole image along each side, in the last image.
    double scale() const { return drawn_scale_; }
    // A copy of the left eye's last image, the wide one (layout TRANSFER_SRC); null where there is none or images are
    // not kept.
    const gpu::DeviceImage* left() const { return has_left_ ? &*left_ : nullptr; }
    const stage::Camera& left_camera() const { return cameras_[0]; }  // of that image, in the world

  private:
    void choose_size(double budget_ms, double last_ms);
    // The share of the rays that a view with a ray in each pixel has, along each side.
    double ray_share(uint32_t view, bool follows_gaze) const;
    void update_hidden_triangles(render::StageRenderer& renderer, const xr::EyeViews& eyes);
    render::FrameSettings settings_of(const render::StageRenderer& renderer, const stage::EvaluatedStage& evaluated,
                                      const render::PerformerHighlight& highlight,
                                      std::span<const render::Instance> next, bool follows_gaze) const;
    void record_left(gpu::Commands& commands, VkImage image);
    const gpu::Device& device_;
    const xr::Session& session_;
    EyeQuality quality_;
    std::unique_ptr<xr::SwapchainImages> colour_, depth_;
    gpu::DeviceImage fallback_depth_;
    xr::EyePass pass_;
    // By view, as the members below that are vectors.
    std::vector<stage::Camera> cameras_;
    std::vector<char> mask_outdated_;
    std::vector<XrFovf> mask_fov_;
    std::vector<std::vector<glm::vec2>> hidden_;
    bool hides_ = false;  // whether the renderer has hidden_
    editor::DynamicScale dynamic_scale_;
    DrawnShare share_;
    VkExtent2D drawn_size_{};  // of the part of the swapchain's image that is drawn
    double ray_scale_ = 1;     // rays per pixel of that part along each side
    double drawn_scale_ = 1;
    uint32_t same_scale_ = 0;  // images in a row that were drawn at this scale
    xr::EyeViews drawn_eyes_;
    std::optional<gpu::DeviceImage> left_;
    bool has_left_ = false;  // left_ has been drawn to
    bool has_drawn_ = false;
    bool overlaps_;  // whether the next image is recorded while the device draws this one
    bool shows_room_ = false;
    std::optional<glm::dvec3> looks_at_;
    XrCompositionLayerProjection projection_{XR_TYPE_COMPOSITION_LAYER_PROJECTION};
    std::vector<XrCompositionLayerProjectionView> views_;
    std::vector<XrCompositionLayerDepthInfoKHR> depths_;
};

}  // namespace neuvv::headset
